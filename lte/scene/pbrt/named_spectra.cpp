#include "lte/scene/pbrt/named_spectra.h"

#include <cmath>
#include <string>

#include "lte/scene/import/compressed_file.h"
#include "lte/scene/pbrt/parser.h"

namespace lte::scene::pbrt {
namespace {

constexpr size_t kMaxSpectrumBytes = 1 << 24;

[[noreturn]] void fail_type(const Parameter& parameter) {
  fail(parameter.at, "parameter ", quote(parameter.name), " cannot be of type ", parameter.type);
}

void check_values(const Parameter& parameter, size_t wanted) {
  if (parameter.numbers.size() != wanted)
    fail(parameter.at, "parameter ", quote(parameter.name), " of type ", parameter.type, " takes ",
         wanted, wanted == 1 ? " value" : " values", ", got ", parameter.numbers.size());
}

Rgb read_rgb(const Parameter& parameter) {
  check_values(parameter, parameter.type == "float" ? 1 : 3);
  const std::vector<double>& n = parameter.numbers;
  Rgb out;
  for (int c = 0; c < 3; ++c)
    out[c] = finite_float(parameter, n[n.size() == 1 ? 0 : static_cast<size_t>(c)]);
  if (parameter.type == "xyz") {
    const float y = out.y, sum = out.x + out.y + out.z;
    out = y > 0 ? chromaticity_to_rgb(out.x / sum, y / sum) * y : Rgb{};
  }
  if (out.x < 0 || out.y < 0 || out.z < 0)
    fail(parameter.at, "parameter ", quote(parameter.name), " has a negative value");
  return out;
}

bool is_rgb(const Parameter& parameter) {
  return parameter.type == "rgb" || parameter.type == "xyz" || parameter.type == "float";
}

Spectrum to_pairs(const Parameter& parameter, const std::vector<double>& numbers) {
  if (numbers.empty() || numbers.size() % 2 != 0)
    fail(parameter.at, "parameter ", quote(parameter.name),
         ": expected pairs of a wavelength and a value, got ", numbers.size(), " numbers");
  Spectrum out;
  for (size_t i = 0; i < numbers.size(); i += 2) {
    if (i > 0 && !(numbers[i] > numbers[i - 2]))
      fail(parameter.at, "parameter ", quote(parameter.name), ": wavelengths must ascend, but ",
           numbers[i], " follows ", numbers[i - 2]);
    finite_float(parameter, numbers[i + 1]);
    out.push_back({numbers[i], numbers[i + 1]});
  }
  return out;
}

/// Pairs in the scene, or in a file that it names.
Spectrum read_pairs(const Parameter& parameter, const Files& files) {
  if (parameter.strings.empty()) return to_pairs(parameter, parameter.numbers);
  const SceneFilePtr found = files.find(parameter.strings[0], parameter.at);
  const CompressedFile file(found, &files.budget());
  if (file.text().size() > kMaxSpectrumBytes)
    fail(parameter.at, quote(parameter.strings[0]), " is longer than a spectrum may be, ",
         kMaxSpectrumBytes, " bytes");
  const TextFile name{found->name(), found->outside()};
  Tokenizer tokens(&name, file.text());
  std::vector<double> numbers;
  for (Token token = tokens.next(); token.kind != Token::End; token = tokens.next())
    numbers.push_back(parse_number(token));
  try {
    return to_pairs(parameter, numbers);
  } catch (const Error&) {
    if (found->outside()) fail(parameter.at, "a file outside the folder holds no spectrum");
    throw;
  }
}

/// A spectrum's name, or "" for pairs and files of pairs.
std::string name_of(const Parameter& parameter) {
  if (parameter.strings.size() > 1)
    fail(parameter.at, "parameter ", quote(parameter.name), " takes one name, got ",
         parameter.strings.size());
  if (parameter.strings.empty()) return "";
  const std::string& name = parameter.strings[0];
  for (const char* prefix :
       {"metal-", "glass-", "stdillum-", "illum-", "canon_", "nikon_", "sony_"}) {
    if (name.starts_with(prefix)) return name;
  }
  return "";
}

/// "Cu" of "metal-Cu-eta" and "metal-Cu-k".
std::string substance_of(const std::string& name) {
  if (!name.starts_with("metal-")) return "";
  return name.substr(6, name.rfind('-') - 6);
}

Rgb unknown_spectrum(const std::string& name, const Rgb& used, const Parameter& parameter,
                     IgnoredFeatures* ignored) {
  ignored->add(concat("named spectrum ", quote(name), " is not known here, ", used.x, " taken"),
               parameter.at);
  return used;
}

bool is_pairs(const Parameter& parameter) {
  return parameter.type == "spectrum" && name_of(parameter).empty();
}

/// The value of one channel where n or k is given as rgb or as one number.
Rgb conductor_of_rgb(const Rgb& eta, const Rgb& k) {
  Rgb out;
  for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(conductor_reflectance(eta[c], k[c]));
  return out;
}

}  // namespace

Rgb to_reflectance(const Parameter& parameter, const Files& files, IgnoredFeatures* ignored) {
  if (is_rgb(parameter)) return read_rgb(parameter);
  if (parameter.type != "spectrum") fail_type(parameter);
  const std::string name = name_of(parameter);
  if (name.empty()) return reflectance_to_rgb(read_pairs(parameter, files));
  return unknown_spectrum(name, {0.5f, 0.5f, 0.5f}, parameter, ignored);
}

Rgb to_illuminant(const Parameter& parameter, const Files& files, IgnoredFeatures* ignored) {
  if (is_rgb(parameter)) return read_rgb(parameter);
  if (parameter.type == "blackbody") {
    // pbrt-v3 gave a scale behind the temperature, and radiance in absolute units.
    if (parameter.numbers.size() == 2)
      ignored->add("pbrt-v3 blackbody: its scale is ignored, luminance 1 taken", parameter.at);
    else
      check_values(parameter, 1);
    const double kelvin = parameter.numbers[0];
    if (!(kelvin >= 100 && kelvin <= 1e6))
      fail(parameter.at, "parameter ", quote(parameter.name), ": ", kelvin,
           " K, expected 100 to 1000000");
    return blackbody_to_rgb(kelvin);
  }
  if (parameter.type != "spectrum") fail_type(parameter);
  const std::string name = name_of(parameter);
  if (name.empty()) return illuminant_to_rgb(read_pairs(parameter, files));
  if (const std::optional<Rgb> rgb = named_illuminant(name)) return *rgb;
  return unknown_spectrum(name, {1, 1, 1}, parameter, ignored);
}

Rgb to_conductor(const Parameter* eta, const Parameter* k, const Files& files,
                 IgnoredFeatures* ignored) {
  for (const Parameter* parameter : {eta, k}) {
    if (parameter != nullptr && !is_rgb(*parameter) && parameter->type != "spectrum")
      fail_type(*parameter);
  }
  if (eta != nullptr && k != nullptr && is_rgb(*eta) && is_rgb(*k))
    return conductor_of_rgb(read_rgb(*eta), read_rgb(*k));
  if (eta != nullptr && k != nullptr && is_pairs(*eta) && is_pairs(*k))
    return conductor_to_rgb(read_pairs(*eta, files), read_pairs(*k, files));
  const auto substance = [](const Parameter* parameter) {
    return parameter == nullptr ? "Cu" : substance_of(name_of(*parameter));
  };
  const std::string metal = substance(eta);
  const std::optional<Rgb> rgb = named_conductor(metal);
  if (rgb && metal == substance(k)) return *rgb;
  const Parameter& shown = eta != nullptr ? *eta : *k;
  ignored->add("eta and k of a conductor that is not known here, 0.5 taken", shown.at);
  return {0.5f, 0.5f, 0.5f};
}

}  // namespace lte::scene::pbrt
