#include "lte/cli/set_keys.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/base/text.h"
#include "lte/base/to_number.h"

namespace lte {
namespace {

template <typename Number>
SetKeys::Read reads_number(Number* value, Number low, Number high, const char* what) {
  return [=](const std::string& text) -> std::string {
    const auto read = to_number<Number>(without_plus(text));
    if (!read || !(*read >= low && *read <= high))
      return concat("expected ", what, " from ", low, " to ", high);
    *value = *read;
    return "";
  };
}

std::string alternatives(const std::vector<std::string>& words) {
  std::string out;
  for (size_t i = 0; i < words.size(); ++i)
    out += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return out;
}

}  // namespace

void SetKeys::add(const std::string& key, const std::string& kind, Read read, Show show,
                  const std::string& help) {
  keys_.push_back({key, kind, help, std::move(read), std::move(show)});
}

void SetKeys::add(const std::string& key, int64_t* value, int64_t low, int64_t high,
                  const std::string& help) {
  add(
      key, "N", reads_number(value, low, high, "a whole number"),
      [value] { return concat(*value); }, help);
}

void SetKeys::add(const std::string& key, int* value, int low, int high, const std::string& help) {
  add(
      key, "N", reads_number(value, low, high, "a whole number"),
      [value] { return concat(*value); }, help);
}

void SetKeys::add(const std::string& key, double* value, double low, double high,
                  const std::string& help) {
  add(
      key, "F", reads_number(value, low, high, "a number"), [value] { return concat(*value); },
      help);
}

void SetKeys::add(const std::string& key, bool* value, const std::string& help) {
  const auto read = [value](const std::string& text) -> std::string {
    if (text != "on" && text != "off") return "expected on or off";
    *value = text == "on";
    return "";
  };
  add(
      key, "on|off", read, [value] { return std::string(*value ? "on" : "off"); }, help);
}

void SetKeys::add(const std::string& key, std::string* value, std::vector<std::string> words,
                  const std::string& help) {
  std::string kind;
  for (const std::string& word : words) kind += (kind.empty() ? "" : "|") + word;
  const auto read = [value, words = std::move(words)](const std::string& text) -> std::string {
    if (std::ranges::find(words, text) == words.end()) return "expected " + alternatives(words);
    *value = text;
    return "";
  };
  add(
      key, kind, read, [value] { return *value; }, help);
}

void SetKeys::add_to(CLI::App* app) {
  std::string help = "Expert settings, repeatable:";
  for (const Key& key : keys_)
    help += concat("\n", key.name, "=", key.kind, " (", key.show(), ")  ", key.help);
  option_ = app->add_option("--set", values_, help);
  option_->type_name("KEY=VALUE")->allow_extra_args(false);
}

SetKeys::Key* SetKeys::find(const std::string& name) {
  const auto found = std::ranges::find(keys_, name, &Key::name);
  return found != keys_.end() ? &*found : nullptr;
}

void SetKeys::read() {
  for (const std::string& setting : values_) {
    const size_t equals = setting.find('=');
    LTE_CHECK(equals != std::string::npos, "--set ", setting, ": expected KEY=VALUE");
    const std::string name = setting.substr(0, equals), text = setting.substr(equals + 1);
    Key* const key = find(name);
    if (key == nullptr) {
      std::vector<std::string> names;
      for (const Key& known : keys_) names.push_back(known.name);
      const std::string nearest = nearest_name(name, names);
      throw Error(concat(
          "--set: unknown key \"", name, "\"",
          nearest.empty() ? "; --help lists them" : concat("; did you mean ", nearest, "?")));
    }
    const std::string wrong = key->read(text);
    LTE_CHECK(wrong.empty(), "--set ", name, ": ", wrong, ", got \"", text, "\"");
    key->given = true;
  }
  if (option_ == nullptr) return;
  option_->clear();  // printed configurations list what is in force, given or not
  option_->add_result(in_force());
}

bool SetKeys::is_given(const std::string& name) const {
  const auto found = std::ranges::find(keys_, name, &Key::name);
  LTE_CHECK(found != keys_.end(), "there is no key ", name);
  return found->given;
}

std::vector<std::string> SetKeys::in_force() const {
  std::vector<std::string> out;
  for (const Key& key : keys_) out.push_back(key.name + "=" + key.show());
  return out;
}

}  // namespace lte
