// SPDX-License-Identifier: Apache-2.0
//
// An OpenEXR file opened for reading and checked: nothing that its header promises is larger than the file can hold.
// Files that belong to it, for renderers that write one per buffer, add their parts behind its own.
#pragma once

#include <ImfCompression.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPixelType.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "exr/byte_progress.hpp"
#include "exr/guarded_stream.hpp"
#include "stein/error.hpp"
#include "stein/plane.hpp"

namespace stein::exr {

struct SourceChannel {
  int part = 0;
  std::string name;  ///< as in the file
  Imf::PixelType type = Imf::FLOAT;
  bool subsampled = false;
};

/// A further file, whose parts are to bear its name.
struct Companion {
  std::string path;
  std::string name;
  bool operator==(const Companion&) const = default;
};

class SourceFile {
 public:
  /// `progress` is told what is read of all files together.
  /// @throws Error kIo naming the file.
  explicit SourceFile(std::string path, const std::vector<Companion>& companions = {},
                      const std::function<bool(double)>& progress = {});

  /// For what is done between two reads. @throws Error kCancelled.
  void check_not_cancelled() { progress_->advance(0); }

  [[nodiscard]] const std::string& path() const noexcept { return files_[0].path; }
  [[nodiscard]] int parts() const noexcept { return static_cast<int>(parts_.size()); }
  [[nodiscard]] bool is_own(int part) const { return at(part).file == 0; }  ///< not of a companion
  [[nodiscard]] const std::string& path(int part) const { return files_[at(part).file].path; }
  [[nodiscard]] std::int64_t size(int part) const { return files_[at(part).file].size; }  ///< bytes of its file
  /// The part's file, and its number there.
  [[nodiscard]] Imf::MultiPartInputFile& input(int part) { return *files_[at(part).file].input; }
  [[nodiscard]] int number(int part) const { return at(part).number; }
  [[nodiscard]] const Imf::Header& header(int part) const { return files_[at(part).file].input->header(number(part)); }
  [[nodiscard]] std::string part_name(int part) const;
  [[nodiscard]] bool is_deep(int part) const;
  [[nodiscard]] bool is_tiled(int part) const;
  /// Channels of all parts, in the order of the parts, then of the names.
  [[nodiscard]] const std::vector<SourceChannel>& channels() const noexcept { return channels_; }

  /// @throws Error kIo if scanlines or tiles of the part are missing.
  void require_complete(int part) const;

 private:
  struct File {
    std::string path;
    std::string name;  // of a companion
    std::int64_t size = 0;
    std::unique_ptr<GuardedStream> stream;
    std::unique_ptr<Imf::MultiPartInputFile> input;
  };
  struct Part {
    std::size_t file = 0;
    int number = 0;
  };

  void open(std::string path, std::string name);
  [[nodiscard]] const Part& at(int part) const { return parts_[static_cast<std::size_t>(part)]; }

  std::unique_ptr<ByteProgress> progress_;  // streams refer to it
  std::vector<File> files_;
  std::vector<Part> parts_;
  std::vector<SourceChannel> channels_;
};

/// Size of a part's data window. Checked on opening to be within what an int and the file can hold.
[[nodiscard]] int width_of(const Imf::Header& header);
[[nodiscard]] int height_of(const Imf::Header& header);
[[nodiscard]] std::array<int, 4> window_of(const Imf::Header& header);

/// An upper bound of what the codec can squeeze a constant image by.
[[nodiscard]] std::int64_t largest_ratio(Imf::Compression compression);

[[nodiscard]] ScalarType scalar_type(Imf::PixelType type);
[[nodiscard]] Imf::PixelType pixel_type(ScalarType type);

/// Runs `work` and turns whatever OpenEXR or the standard library throws into Error kIo: "cannot <action>: <why>".
template <class Work>
auto with_io_errors(const std::string& action, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kIo, "cannot " + action + ": not enough memory for its planes", ENOMEM);
  } catch (const std::exception& error) {
    throw Error(ErrorCode::kIo, "cannot " + action + ": " + error.what());
  }
}

}  // namespace stein::exr
