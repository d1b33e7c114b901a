#include "lte/image/exr.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>
#include <set>
#include <stdexcept>
#include <string>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "lte/base/file.h"
#include "lte/image/finite_half.h"

namespace lte::image {
namespace {

/// Bounds what a hostile header can make us allocate.
constexpr int64_t kMaxPixels = int64_t{1} << 28;
constexpr int kMaxSide = 1 << 20;
/// Rows read at once; the tallest compressed block of OpenEXR.
constexpr int64_t kStrip = 256;

/// Collects the file in memory: OpenEXR's own stream swallows the errors of its last flush, such as
/// a full disk.
class MemoryOutput : public Imf::OStream {
 public:
  explicit MemoryOutput(const std::string& name) : OStream(name.c_str()) {}

  void write(const char bytes[], int size) override {
    const auto count = static_cast<size_t>(size);
    if (place_ + count > data_.size()) data_.resize(place_ + count);
    std::memcpy(data_.data() + place_, bytes, count);
    place_ += count;
  }
  uint64_t tellp() override { return place_; }
  void seekp(uint64_t place) override { place_ = place; }
  const std::string& data() const { return data_; }

 private:
  std::string data_;
  size_t place_ = 0;
};

class MemoryInput : public Imf::IStream {
 public:
  MemoryInput(std::string_view file, const std::string& name)
      : IStream(name.c_str()), file_(file) {}

  bool read(char bytes[], int size) override {
    const auto count = static_cast<size_t>(std::max(size, 0));
    if (place_ > file_.size() || count > file_.size() - place_) {
      throw std::runtime_error("unexpected end of file");
    }
    std::memcpy(bytes, file_.data() + place_, count);
    place_ += count;
    return place_ < file_.size();
  }
  uint64_t tellg() override { return place_; }
  void seekg(uint64_t place) override { place_ = place; }

 private:
  std::string_view file_;
  uint64_t place_ = 0;
};

std::string channel_name(const std::string& layer, const char* suffix) {
  return layer.empty() ? suffix : layer + "." + suffix;
}

std::vector<std::string> channel_names(const std::string& layer, int channels) {
  const bool vector = layer == "normal" || layer == "position";
  std::vector<const char*> suffixes = {"R", "G", "B"};
  if (vector) suffixes = {"X", "Y", "Z"};
  if (channels == 1) suffixes = {layer == "depth" ? "Z" : "Y"};
  std::vector<std::string> names;
  for (const char* suffix : suffixes) names.push_back(channel_name(layer, suffix));
  return names;
}

/// The channels of `layer` in a file, whoever wrote it; empty if it has no such layer.
std::vector<std::string> find_channels(const Imf::ChannelList& channels, const std::string& layer) {
  const std::vector<std::vector<const char*>> forms = {
      {"R", "G", "B"}, {"X", "Y", "Z"}, {"Y"}, {"Z"}};
  for (const auto& form : forms) {
    std::vector<std::string> names;
    for (const char* suffix : form) {
      if (channels.findChannel(channel_name(layer, suffix)))
        names.push_back(channel_name(layer, suffix));
    }
    if (names.size() == form.size()) return names;
  }
  return {};
}

std::string layer_list(const Imf::ChannelList& channels) {
  std::set<std::string> layers;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    const std::string name = channel.name();
    const size_t dot = name.rfind('.');
    layers.insert(dot == std::string::npos ? "" : name.substr(0, dot));
  }
  std::string text;
  for (const std::string& layer : layers) {
    if (find_channels(channels, layer).empty()) continue;
    text += concat(text.empty() ? "" : ", ", layer.empty() ? "(unnamed)" : layer);
  }
  return text.empty() ? "none that can be read" : text;
}

/// A slice per channel into interleaved pixels, so that neither direction copies.
void add_slices(const std::vector<std::string>& names, const Imath::Box2i& window,
                Imf::PixelType type, char* pixels, Imf::FrameBuffer* buffer) {
  const size_t size = type == Imf::HALF ? sizeof(Half) : sizeof(float);
  const size_t stride = names.size() * size;
  const auto width = static_cast<size_t>(window.max.x - window.min.x + 1);
  for (size_t i = 0; i < names.size(); ++i) {
    buffer->insert(names[i],
                   Imf::Slice::Make(type, pixels + i * size, window, stride, stride * width));
  }
}

std::vector<Half> to_halves(const Image& image) {
  std::vector<Half> out;
  out.reserve(image.pixels.size());
  for (const float value : image.pixels) out.push_back(to_finite_half(value));
  return out;
}

void check_layers(const std::string& path, const std::vector<Layer>& layers) {
  LTE_CHECK(!layers.empty(), path, ": no layers to write");
  std::set<std::string> names;
  for (const Layer& layer : layers) {
    LTE_CHECK(layer.image != nullptr, path, ": layer \"", layer.name, "\" has no image");
    const Image &image = *layer.image, &first = *layers.front().image;
    LTE_CHECK(names.insert(layer.name).second, path, ": layer \"", layer.name, "\" is given twice");
    LTE_CHECK(image.channels == 1 || image.channels == 3, path, ": layer \"", layer.name,
              "\": expected 1 or 3 channels, got ", image.channels);
    LTE_CHECK(image.width == first.width && image.height == first.height, path, ": layer \"",
              layer.name, "\" is ", image.width, " x ", image.height, ", the first layer ",
              first.width, " x ", first.height);
    LTE_CHECK(image.width > 0 && image.height > 0, path, ": layer \"", layer.name, "\" is empty");
  }
}

DeclaredSize size_of(const Imath::Box2i& window) {
  return {int64_t{window.max.x} - window.min.x + 1, int64_t{window.max.y} - window.min.y + 1};
}

/// Opens the file and hands its stream to `read`. Errors of OpenEXR get the file's name.
template <typename Read>
auto with_input(std::string_view bytes, const std::string& name, const Read& read) {
  // Refused while the header is parsed, before OpenEXR allocates its table of line offsets.
  static std::once_flag once;
  std::call_once(once, [] { Imf::Header::setMaxImageSize(kMaxSide, kMaxSide); });
  MemoryInput input(bytes, name);
  try {
    return read(input);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(concat(name, ": cannot read as OpenEXR: ", error.what()));
  }
}

Image read_layer(const std::string& path, Imf::IStream& stream, const std::string& layer) {
  Imf::InputFile file(stream);
  const Imath::Box2i window = file.header().dataWindow();
  const auto [width, height] = size_of(window);
  LTE_CHECK(width > 0 && height > 0 && width <= kMaxSide && height <= kMaxSide &&
                width * height <= kMaxPixels,
            path, ": ", width, " x ", height, " pixels exceed the limit of ", kMaxPixels);
  const Imf::ChannelList& channels = file.header().channels();
  const std::vector<std::string> names = find_channels(channels, layer);
  LTE_CHECK(!names.empty(), path, ": has no layer \"", layer, "\"; it has: ", layer_list(channels));
  for (const std::string& name : names) {
    const Imf::Channel* channel = channels.findChannel(name);
    LTE_CHECK(channel->xSampling == 1 && channel->ySampling == 1, path, ": channel ", name,
              " is subsampled, which is not supported");
  }
  Image image;
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  image.channels = static_cast<int>(names.size());
  const size_t row = static_cast<size_t>(width) * names.size();
  image.pixels.reserve(row * static_cast<size_t>(height));
  Imf::FrameBuffer buffer;
  add_slices(names, window, Imf::FLOAT, reinterpret_cast<char*>(image.pixels.data()), &buffer);
  file.setFrameBuffer(buffer);
  // Strip by strip, so that a small file with a large header fails before the memory is touched.
  for (int64_t begin = 0; begin < height; begin += kStrip) {
    const int64_t end = std::min(begin + kStrip, height);
    image.pixels.resize(row * static_cast<size_t>(end));
    file.readPixels(static_cast<int>(window.min.y + begin),
                    static_cast<int>(window.min.y + end - 1));
  }
  return image;
}

}  // namespace

void write_exr(const std::filesystem::path& path, const std::vector<Layer>& layers,
               const ExrTexts& texts, ExrChannels channels) {
  check_layers(path.string(), layers);
  const Image& first = *layers.front().image;
  Imf::Header header(first.width, first.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [name, text] : texts) header.insert(name, Imf::StringAttribute(text));
  const bool half = channels == ExrChannels::Half;
  Imf::FrameBuffer buffer;
  std::vector<std::vector<Half>> halves;
  for (const Layer& layer : layers) {
    const std::vector<std::string> names = channel_names(layer.name, layer.image->channels);
    for (const std::string& name : names)
      header.channels().insert(name, Imf::Channel(half ? Imf::HALF : Imf::FLOAT));
    if (half) halves.push_back(to_halves(*layer.image));
    // OpenEXR's slices point to mutable memory in both directions; writing only reads it.
    void* const pixels = half ? static_cast<void*>(halves.back().data())
                              : const_cast<float*>(layer.image->pixels.data());
    add_slices(names, header.dataWindow(), half ? Imf::HALF : Imf::FLOAT,
               static_cast<char*>(pixels), &buffer);
  }
  MemoryOutput memory(path.string());
  try {
    Imf::OutputFile output(memory, header);
    output.setFrameBuffer(buffer);
    output.writePixels(first.height);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(concat(path.string(), ": cannot encode: ", error.what()));
  }
  AtomicFile file(path);
  file.write(memory.data());
  file.commit();
}

Image read_exr(const std::filesystem::path& path, const std::string& layer) {
  const MappedFile file(path);
  return decode_exr({reinterpret_cast<const char*>(file.data()), file.size()}, path.string(),
                    layer);
}

Image decode_exr(std::string_view bytes, const std::string& name, const std::string& layer) {
  return with_input(bytes, name,
                    [&](Imf::IStream& input) { return read_layer(name, input, layer); });
}

std::optional<std::string> read_exr_text(const std::filesystem::path& path,
                                         const std::string& attribute) {
  const MappedFile mapped(path);
  const std::string_view bytes(reinterpret_cast<const char*>(mapped.data()), mapped.size());
  return with_input(bytes, path.string(), [&](Imf::IStream& input) -> std::optional<std::string> {
    const Imf::InputFile file(input);
    const auto* text = file.header().findTypedAttribute<Imf::StringAttribute>(attribute);
    if (text == nullptr) return std::nullopt;
    return text->value();
  });
}

DeclaredSize declared_exr_size(std::string_view bytes, const std::string& name) {
  return with_input(bytes, name, [](Imf::IStream& input) {
    return size_of(Imf::InputFile(input).header().dataWindow());
  });
}

}  // namespace lte::image
