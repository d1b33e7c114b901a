#include <algorithm>

#include "infer/bench/pareto/method.h"
#include "lte/base/check.h"

namespace lte::infer {

std::vector<Method> all_methods() {
  std::vector<Method> out;
  for (const int paths : {1, 4, 16, 64, 256, 1024}) out.push_back(path_tracing(paths));
  for (const int paths : {1, 4, 16, 64}) out.push_back(denoised_paths(paths));
  for (const int step : {2, 4})
    for (const int paths : {4, 16}) out.push_back(reduced_paths(step, paths));
  for (const int samples : {1, 4, 16, 64}) out.push_back(network_everywhere(samples));
  out.push_back(network_draft());
  for (const int samples : {4, 16}) out.push_back(network_sparsely(samples));
  for (const int64_t points : {1'024, 4'096, 16'384}) out.push_back(light_estimates(points, 32));
  out.push_back(light_estimates(4'096, 8));
  out.push_back(light_map(int64_t{1} << 14, 64));
  out.push_back(light_map(int64_t{1} << 16, 16));
  out.push_back(light_map(int64_t{1} << 18, 16));
  for (const int rays : {4, 16, 64}) out.push_back(gathered_light(rays));
  for (const int rays : {4, 16}) out.push_back(gathered_sparsely(rays));
  for (const DraftKind kind : {DraftKind::Plain, DraftKind::Large, DraftKind::Kept})
    out.push_back(gathered_draft(kind));
  out.push_back(gathered_from_network(16));
  out.push_back(gathered_final());
  out.push_back(gathered_final(64));
  for (const int paths : {8, 64}) out.push_back(network_corrected(paths));
  for (const double seconds : {0.5, 1.0, 2.0, 5.0, 10.0, 30.0}) out.push_back(time_budget(seconds));
  return out;
}

std::vector<Method> choose_methods(const std::vector<std::string>& words) {
  const std::vector<Method> all = all_methods();
  if (words.empty()) return all;
  std::vector<std::string> families;
  std::string list;
  for (const Method& method : all) {
    if (std::find(families.begin(), families.end(), method.family) != families.end()) continue;
    families.push_back(method.family);
    list += (list.empty() ? "" : ", ") + method.family;
  }
  const auto is_word = [](const Method& method, const std::string& word) {
    return method.name == word || method.family == word;
  };
  for (const std::string& word : words) {
    LTE_CHECK(std::any_of(all.begin(), all.end(),
                          [&](const Method& method) { return is_word(method, word); }),
              "--methods: \"", word, "\" is no method: expected a family (", list,
              ") or one of its rows, such as ", all.front().name);
  }
  std::vector<Method> out;
  for (const Method& method : all) {
    if (std::any_of(words.begin(), words.end(),
                    [&](const std::string& word) { return is_word(method, word); }))
      out.push_back(method);
  }
  return out;
}

}  // namespace lte::infer
