// The irradiance of a band's queries from answers at few of them.
#pragma once

#include <span>
#include <vector>

#include "infer/picture/picture_band.h"
#include "lte/gi/sparse_pixels.h"

namespace lte::infer {

struct SparseLight {
  std::vector<Rgb> irradiance;  ///< an entry a query of the band
  int64_t answers = 0;          ///< queries that were answered, those of anti-aliasing included
};

/// Fills the entries of `values` beyond the centres' from pixels near them on their surface.
/// @param values  irradiance, an entry a query; the centres' are there
/// @return        the queries that no pixel stands for
std::vector<size_t> interpolate_extras(const PictureBand& band, std::vector<Rgb>* values);
/// The same where the light of centres is known (BandOptions::centres_known).
/// @param of_pixel  irradiance, an entry a pixel of the band
/// @param values    an entry a query
std::vector<size_t> interpolate_extras(const PictureBand& band, std::span<const Rgb> of_pixel,
                                       std::span<Rgb> values);

/// Answers pixel centres through the quadtree. A query that anti-aliasing added takes the mean of
/// pixels next to it that see its surface; only where none does, it is answered itself.
SparseLight light_sparsely(const PictureBand& band, const gi::SparseOptions& options,
                           const gi::Answerer& answer);

/// Every query of the band, without the quadtree. Those for pixel centres are asked apart from
/// those that anti-aliasing adds: matrix products of other sizes may round otherwise, and centres
/// keep every bit.
SparseLight light_everywhere(const PictureBand& band, const gi::Answerer& answer);

}  // namespace lte::infer
