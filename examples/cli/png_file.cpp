// SPDX-License-Identifier: Apache-2.0
#include "png_file.hpp"

#include <png.h>

#include <string>

#include "output_file.hpp"
#include "stein/error.hpp"

namespace stein::cli {

void write_png(const std::string& path, const Picture& picture) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width());
  image.height = static_cast<png_uint_32>(picture.height());
  image.format = PNG_FORMAT_RGB;

  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);  // an upper bound, then what was written
  std::string content(size, '\0');
  if (png_image_write_to_memory(&image, content.data(), &size, 0, picture.data(), 0, nullptr) == 0) {
    throw Error(ErrorCode::kIo, "cannot encode '" + path + "' as PNG: " + image.message);
  }
  content.resize(size);
  write_whole_file(path, content);
}

}  // namespace stein::cli
