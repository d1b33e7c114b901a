#include "infer/check/check_report.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"
#include "lte/base/text.h"

namespace lte::infer {
namespace {

std::string text_of(const CheckedRatio& ratio) {
  return formatted("%.2f (+-%.2f)", ratio.ratio, std::max(ratio.standard_error, 0.01));
}

nlohmann::json ratio_json(const CheckedRatio& ratio) {
  return {{"ratio", ratio.ratio},
          {"standard_error", ratio.standard_error},
          {"expected_error", std::sqrt(ratio.expected_square)},
          {"share", ratio.share},
          {"centre", {ratio.centre.x, ratio.centre.y, ratio.centre.z}},
          {"off", ratio.off}};
}

}  // namespace

std::string check_note(const LightCheck& check, std::string_view who, std::string_view where) {
  if (!check.off()) return "";
  const std::string light = concat(who, " indirect light is ");
  // A fault that is nearly everywhere is that of the whole.
  const bool everywhere = !check.fault || (check.whole.off && check.fault->share > 0.9);
  if (everywhere) return concat(light, text_of(check.whole), " of the traced");
  const Vec3& at = check.fault->centre;
  const std::string place =
      formatted("around %.2f,%.2f,%.2f; %.0f %% of ", double{at.x}, double{at.y}, double{at.z},
                std::max(1.0, 100 * check.fault->share));
  if (!check.whole.off)
    return concat(light, text_of(*check.fault), " of the traced here (", place, where, ")");
  return concat(light, text_of(check.whole), " of the traced, and ", text_of(*check.fault),
                " where it is off by the most (", place, where, ")");
}

nlohmann::json check_json(const LightCheck& check) {
  if (check.paths == 0) return false;
  nlohmann::json regions = nlohmann::json::array();
  for (const CheckedRatio& region : check.regions) regions.push_back(ratio_json(region));
  return {{"whole", ratio_json(check.whole)},
          {"fault", check.fault ? ratio_json(*check.fault) : nlohmann::json()},
          {"regions", regions},
          {"expected_error", std::sqrt(check.whole.expected_square)},
          {"paths", check.paths},
          {"seconds", check.seconds}};
}

}  // namespace lte::infer
