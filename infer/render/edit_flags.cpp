#include "infer/render/edit_flags.h"

namespace lte::infer {

void add_edit_flags(CLI::App& app, EditFlags* flags) {
  app.add_option("--edit", flags->script,
                 "Pictures of a scene that changes: a YAML file of edits with frames "
                 "(docs/editing.md); --out is a pattern, and all pictures share one exposure")
      ->check(CLI::ExistingFile);
}

void claim_edits(const EditFlags& flags, CommandFiles* files) {
  files->reads("--edit", flags.script);
}

}  // namespace lte::infer
