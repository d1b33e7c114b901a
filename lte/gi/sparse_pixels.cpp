#include "lte/gi/sparse_pixels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/gi/contacts.h"
#include "lte/gi/upsample.h"

namespace lte::gi {
namespace {

constexpr int64_t kRows = 8;  ///< that a thread takes at a time
constexpr int kMostStep = 64;
/// Share of the picture's mean below which a difference is not seen.
constexpr float kMeanShare = 0.1f;

bool is_power_of_two(int value) {
  return value > 0 && std::has_single_bit(static_cast<unsigned>(value));
}

float greatest_difference(const Rgb& a, const Rgb& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

/// One picture's descent through the levels.
class Refinement {
 public:
  Refinement(const PixelSurfaces& surfaces, std::span<const Rgb> albedo,
             std::span<const uint8_t> wanted, const SparseOptions& options, const Answerer& answer)
      : surfaces_(surfaces),
        albedo_(albedo),
        options_(options),
        answer_(answer),
        must_(find_contacts(surfaces, options.contact_radius)),
        state_(surfaces.size()),
        rough_(surfaces.size()) {
    out_.irradiance.resize(surfaces.size());
    if (must_.empty()) {
      must_.assign(wanted.begin(), wanted.end());
    } else {
      for (size_t i = 0; i < wanted.size(); ++i) must_[i] |= wanted[i];
    }
  }

  SparseAnswers run() {
    answer_coarsest();
    for (int step = options_.step / 2; step >= 1; step /= 2) {
      const bool stopped = options_.stop && options_.stop();
      descend(step, stopped);
    }
    for (uint8_t& state : state_) state = state == kAnswered ? 1 : 0;
    out_.answered = std::move(state_);
    return std::move(out_);
  }

 private:
  enum State : uint8_t { kOpen = 0, kFilled = 1, kAnswered = 2, kAsked = 4 };

  void answer_coarsest() {
    const GridAxis columns(options_.step, surfaces_.width), rows(options_.step, surfaces_.height);
    std::vector<int32_t> pixels;
    for (int row = 0; row < rows.count(); ++row) {
      for (int column = 0; column < columns.count(); ++column) {
        const size_t pixel = surfaces_.at(columns.at(column), rows.at(row));
        if (surfaces_.mask[pixel]) pixels.push_back(static_cast<int32_t>(pixel));
      }
    }
    ask(pixels);
    double sum = 0;
    for (const int32_t pixel : pixels)
      sum += double{max_component(out_.irradiance[static_cast<size_t>(pixel)])};
    floor_ = pixels.empty()
                 ? 0
                 : kMeanShare * static_cast<float>(sum / static_cast<double>(pixels.size()));
    // What the grid of twice the step would have said shows where the next level is needed.
    std::vector<uint8_t> coarse(surfaces_.size());
    const GridAxis wide_columns(2 * options_.step, surfaces_.width),
        wide_rows(2 * options_.step, surfaces_.height);
    for (int row = 0; row < wide_rows.count(); ++row) {
      for (int column = 0; column < wide_columns.count(); ++column) {
        const size_t pixel = surfaces_.at(wide_columns.at(column), wide_rows.at(row));
        coarse[pixel] = state_[pixel];
      }
    }
    for (int row = 0; row < rows.count(); ++row) {
      for (int column = 0; column < columns.count(); ++column) {
        if (!rows.is_new(row) && !columns.is_new(column)) continue;
        const size_t pixel = surfaces_.at(columns.at(column), rows.at(row));
        if (!surfaces_.mask[pixel]) continue;
        const Prediction expected =
            predict(surfaces_, pixel, stencil_at(surfaces_, columns, rows, column, row), coarse,
                    out_.irradiance);
        if (expected.any) compare(pixel, expected.value, options_.step);
      }
    }
  }

  /// Fills or answers what is new on the grid of `step`.
  void descend(int step, bool stopped) {
    const GridAxis columns(step, surfaces_.width), rows(step, surfaces_.height);
    parallel_for(rows.count(), kRows, [&](int64_t begin, int64_t end) {
      for (int row = static_cast<int>(begin); row < end; ++row) {
        for (int column = 0; column < columns.count(); ++column) {
          if (!rows.is_new(row) && !columns.is_new(column)) continue;
          const size_t pixel = surfaces_.at(columns.at(column), rows.at(row));
          if (!surfaces_.mask[pixel]) continue;
          const Prediction expected =
              predict(surfaces_, pixel, stencil_at(surfaces_, columns, rows, column, row), state_,
                      out_.irradiance);
          out_.irradiance[pixel] = expected.value;
          const bool needed =
              needs_answer(pixel, expected, step) || is_rough(columns, rows, column, row, 2 * step);
          if (!expected.any) {
            state_[pixel] = kAsked | kFilled;  // nothing to be compared with
          } else {
            state_[pixel] = needed && !stopped ? kAsked : kFilled;
          }
        }
      }
    });
    std::vector<int32_t> pixels;
    for (int row = 0; row < rows.count(); ++row) {
      for (int column = 0; column < columns.count(); ++column) {
        const size_t pixel = surfaces_.at(columns.at(column), rows.at(row));
        if (state_[pixel] & kAsked) pixels.push_back(static_cast<int32_t>(pixel));
      }
    }
    std::vector<Rgb> expected(pixels.size());
    std::vector<uint8_t> has_expected(pixels.size());
    for (size_t i = 0; i < pixels.size(); ++i) {
      const auto pixel = static_cast<size_t>(pixels[i]);
      expected[i] = out_.irradiance[pixel];
      has_expected[i] = (state_[pixel] & kFilled) ? 0 : 1;
    }
    ask(pixels);
    for (size_t i = 0; i < pixels.size(); ++i) {
      if (has_expected[i]) compare(static_cast<size_t>(pixels[i]), expected[i], step);
    }
  }

  bool needs_answer(size_t pixel, const Prediction& expected, int step) const {
    if (!must_.empty() && must_[pixel]) return true;
    return !expected.complete && step > options_.edge_step;
  }

  /// Whether a corner of the cells of `wide` around a pixel was answered otherwise than predicted.
  bool is_rough(const GridAxis& columns, const GridAxis& rows, int column, int row,
                int wide) const {
    const auto span_of = [](const GridAxis& axis, int index, int cell) {
      const int at = axis.at(index);
      if (axis.is_new(index)) return std::pair(axis.before(index), axis.after(index));
      const int before = at % cell == 0 ? at - cell : at - at % cell;
      return std::pair(std::max(before, 0), std::min(at + cell, axis.last));
    };
    const auto [x0, x1] = span_of(columns, column, wide);
    const auto [y0, y1] = span_of(rows, row, wide);
    const int x = columns.at(column), y = rows.at(row);
    const std::array<int, 3> xs{x0, x, x1}, ys{y0, y, y1};
    for (const int py : ys) {
      for (const int px : xs) {
        if (px == x && py == y) continue;
        if (rough_[surfaces_.at(px, py)] == wide) return true;
      }
    }
    return false;
  }

  void ask(const std::vector<int32_t>& pixels) {
    if (pixels.empty()) return;
    std::vector<Query> queries(pixels.size());
    for (size_t i = 0; i < pixels.size(); ++i) {
      const auto pixel = static_cast<size_t>(pixels[i]);
      queries[i] = {surfaces_.position[pixel], surfaces_.normal[pixel], albedo_[pixel]};
    }
    const std::vector<Rgb> answers = answer_(queries);
    LTE_CHECK(answers.size() == queries.size(), "sparse answers: expected ", queries.size(),
              " answers, got ", answers.size());
    for (size_t i = 0; i < pixels.size(); ++i) {
      out_.irradiance[static_cast<size_t>(pixels[i])] = answers[i];
      state_[static_cast<size_t>(pixels[i])] = kAnswered;
    }
    out_.answers += static_cast<int64_t>(pixels.size());
  }

  void compare(size_t pixel, const Rgb& expected, int step) {
    const Rgb& answer = out_.irradiance[pixel];
    const float scale = std::abs(max_component(answer)) + floor_;
    if (greatest_difference(answer, expected) > options_.tolerance * scale)
      rough_[pixel] = static_cast<uint8_t>(step);
  }

  const PixelSurfaces& surfaces_;
  std::span<const Rgb> albedo_;
  const SparseOptions& options_;
  const Answerer& answer_;
  std::vector<uint8_t> must_;   ///< empty if no pixel has to be answered
  std::vector<uint8_t> state_;  ///< State
  std::vector<uint8_t> rough_;  ///< the step at which an answer was not as predicted, else 0
  float floor_ = 0;             ///< of what differences are compared with, W/m²
  SparseAnswers out_;
};

}  // namespace

void check_sparse_options(const SparseOptions& options) {
  LTE_CHECK(is_power_of_two(options.step) && options.step <= kMostStep,
            "sparse answers: expected a step that is a power of two up to ", kMostStep, ", got ",
            options.step);
  LTE_CHECK(options.edge_step == 0 || is_power_of_two(options.edge_step),
            "sparse answers: expected an edge step that is 0 or a power of two, got ",
            options.edge_step);
  LTE_CHECK(options.tolerance >= 0, "sparse answers: expected a tolerance of 0 or more, got ",
            options.tolerance);
}

SparseAnswers answer_sparsely(const PixelSurfaces& surfaces, std::span<const Rgb> albedo,
                              std::span<const uint8_t> wanted, const SparseOptions& options,
                              const Answerer& answer) {
  check_sparse_options(options);
  const size_t count = surfaces.size();
  LTE_CHECK(surfaces.position.size() == count && surfaces.normal.size() == count &&
                surfaces.depth.size() == count && surfaces.mask.size() == count &&
                albedo.size() == count && (wanted.empty() || wanted.size() == count),
            "sparse answers: expected surfaces and albedo of ", count, " pixels");
  if (count == 0) return {};
  return Refinement(surfaces, albedo, wanted, options, answer).run();
}

}  // namespace lte::gi
