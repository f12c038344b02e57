#pragma once

// Image and text files that tests make for themselves, in a folder that goes when the test ends.

#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace pf::test {

using Bytes = std::vector<uint8_t>;

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "planefold_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
  }
  void write(const std::string& name, const Bytes& bytes) const {
    write(name, std::string(bytes.begin(), bytes.end()));
  }

 private:
  std::filesystem::path path_;
};

inline Bytes make_pgm(int width, int height, const Bytes& pixels, int top = 255) {
  const std::string header = "P5\n# made by a test\n" + std::to_string(width) + " " + std::to_string(height) + "\n" +
                             std::to_string(top) + "\n";
  Bytes bytes(header.begin(), header.end());
  bytes.insert(bytes.end(), pixels.begin(), pixels.end());
  return bytes;
}

/// A PNG with stored (uncompressed) rows. colour_type 0 grey, 2 RGB; depth 8 or 16; rows without filter bytes.
inline Bytes make_png(uint32_t width, uint32_t height, int depth, int colour_type, const Bytes& rows) {
  Bytes out = {0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a};
  const auto put32 = [](Bytes& bytes, uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<uint8_t>(value >> shift));
  };
  const auto chunk = [&](const char* type, const Bytes& data) {
    put32(out, static_cast<uint32_t>(data.size()));
    const size_t begin = out.size();
    out.insert(out.end(), type, type + 4);
    out.insert(out.end(), data.begin(), data.end());
    uint32_t crc = 0xffffffffu;
    for (size_t i = begin; i < out.size(); ++i) {
      crc ^= out[i];
      for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
    }
    put32(out, ~crc);
  };
  Bytes header;
  put32(header, width);
  put32(header, height);
  header.insert(header.end(), {static_cast<uint8_t>(depth), static_cast<uint8_t>(colour_type), 0, 0, 0});
  chunk("IHDR", header);
  Bytes raw;
  const size_t stride = height == 0 ? 0 : rows.size() / height;
  for (size_t y = 0; stride > 0 && y < height; ++y) {
    raw.push_back(0);
    raw.insert(raw.end(), rows.begin() + static_cast<std::ptrdiff_t>(y * stride),
               rows.begin() + static_cast<std::ptrdiff_t>((y + 1) * stride));
  }
  Bytes stream = {0x78, 0x01};
  uint32_t a = 1;
  uint32_t b = 0;
  for (uint8_t byte : raw) {
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  for (size_t at = 0; at < raw.size() || at == 0;) {
    const size_t count = raw.size() - at < 60000 ? raw.size() - at : 60000;
    const auto n = static_cast<uint16_t>(count);
    stream.insert(stream.end(), {static_cast<uint8_t>(at + count == raw.size() ? 1 : 0), static_cast<uint8_t>(n & 255),
                                 static_cast<uint8_t>(n >> 8), static_cast<uint8_t>(~n & 255),
                                 static_cast<uint8_t>((~n >> 8) & 255)});
    stream.insert(stream.end(), raw.begin() + static_cast<std::ptrdiff_t>(at),
                  raw.begin() + static_cast<std::ptrdiff_t>(at + count));
    at += count == 0 ? 1 : count;
  }
  put32(stream, (b << 16) | a);
  chunk("IDAT", stream);
  chunk("IEND", {});
  return out;
}

/// 32 x 32, grey levels 8 x, slightly lossy.
inline Bytes make_jpeg() {
  return {
      0xff, 0xd8, 0xff, 0xfe, 0x00, 0x10, 0x4c, 0x61, 0x76, 0x63, 0x35, 0x39, 0x2e, 0x33, 0x37, 0x2e, 0x31, 0x30, 0x30,
      0x00, 0xff, 0xdb, 0x00, 0x43, 0x00, 0x08, 0x0a, 0x0a, 0x0b, 0x0a, 0x0b, 0x0d, 0x0d, 0x0d, 0x0d, 0x0d, 0x0d, 0x10,
      0x0f, 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x12, 0x12, 0x12, 0x15, 0x15, 0x15, 0x12,
      0x12, 0x12, 0x10, 0x10, 0x12, 0x12, 0x14, 0x14, 0x15, 0x15, 0x17, 0x17, 0x17, 0x15, 0x15, 0x15, 0x15, 0x17, 0x17,
      0x19, 0x19, 0x19, 0x1e, 0x1e, 0x1c, 0x1c, 0x23, 0x23, 0x24, 0x2b, 0x2b, 0x33, 0xff, 0xc4, 0x00, 0x4e, 0x00, 0x01,
      0x01, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x07, 0x08, 0x01,
      0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x10, 0x01,
      0x01, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x04, 0x41, 0x11,
      0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xff, 0xc0,
      0x00, 0x11, 0x08, 0x00, 0x20, 0x00, 0x20, 0x03, 0x01, 0x12, 0x00, 0x02, 0x12, 0x00, 0x03, 0x12, 0x00, 0xff, 0xda,
      0x00, 0x0c, 0x03, 0x01, 0x00, 0x02, 0x11, 0x03, 0x11, 0x00, 0x3f, 0x00, 0x8d, 0xc3, 0x84, 0x38, 0x00, 0xa0, 0x43,
      0x84, 0x38, 0x00, 0xa0, 0x43, 0x84, 0x38, 0x00, 0xa0, 0x43, 0x84, 0x38, 0x00, 0xc7, 0xf0, 0xe1, 0x0e, 0x00, 0x28,
      0x10, 0xe1, 0x0e, 0x00, 0x28, 0x10, 0xe1, 0x0e, 0x00, 0x28, 0x10, 0xe1, 0x0e, 0x00, 0x3f, 0xff, 0xd9,
  };
}

}  // namespace pf::test
