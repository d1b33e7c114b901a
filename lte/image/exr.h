// OpenEXR, linear, with named layers for AOVs.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lte/image/declared_size.h"
#include "lte/image/image.h"

namespace lte::image {

/// One layer. An empty name gives channels R, G, B (or Y for one channel); "albedo" gives albedo.R,
/// albedo.G, albedo.B; a one-channel "depth" gives depth.Z; "normal" and "position" give .X, .Y,
/// .Z. All layers have one size.
struct Layer {
  std::string name;
  const Image* image = nullptr;
};

/// Texts in the header of a file, by attribute name.
using ExrTexts = std::map<std::string, std::string>;

/// How channels are kept. Half holds values beyond its range to its range.
enum class ExrChannels { Float, Half };

/// Writes channels with ZIP compression, atomically.
/// @throws lte::Error if sizes differ, a layer has neither 1 nor 3 channels, or the file cannot be
/// written.
void write_exr(const std::filesystem::path& path, const std::vector<Layer>& layers,
               const ExrTexts& texts = {}, ExrChannels channels = ExrChannels::Float);

/// Reads the channels of one layer (empty name: R, G, B or Y) into an image of 3 or 1 channels.
/// @throws lte::Error naming the file if it is not EXR, or naming the layers it has.
Image read_exr(const std::filesystem::path& path, const std::string& layer = "");

/// The same of bytes in memory.
/// @param name  of the file, for messages
Image decode_exr(std::string_view bytes, const std::string& name, const std::string& layer = "");

/// The size of the data window.
/// @throws lte::Error naming the file if its header is broken.
DeclaredSize declared_exr_size(std::string_view bytes, const std::string& name);

/// Reads a text of the header; nothing if there is no attribute of this name that is a text.
/// @throws lte::Error naming the file if it is not EXR.
std::optional<std::string> read_exr_text(const std::filesystem::path& path,
                                         const std::string& attribute);

}  // namespace lte::image
