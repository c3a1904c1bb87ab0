// SPDX-License-Identifier: Apache-2.0
#include "exr/loaded_frame.hpp"

namespace stein::exr {

LoadedFrame::LoadedFrame() : data_(std::make_unique<Data>()) {}
LoadedFrame::LoadedFrame(LoadedFrame&&) noexcept = default;
LoadedFrame& LoadedFrame::operator=(LoadedFrame&&) noexcept = default;
LoadedFrame::~LoadedFrame() = default;

const Frame& LoadedFrame::frame() const noexcept { return data_->frame; }
const std::vector<ChannelInfo>& LoadedFrame::channels() const noexcept { return data_->channels; }
const std::string& LoadedFrame::path() const noexcept { return data_->path; }
std::array<int, 4> LoadedFrame::data_window() const noexcept { return data_->data_window; }
std::array<float, 3> LoadedFrame::luminance_weights() const noexcept { return data_->colour_space.luminance_weights; }
std::array<float, 9> LoadedFrame::to_rec709() const noexcept { return data_->colour_space.to_rec709; }
const std::vector<std::string>& LoadedFrame::missing() const noexcept { return data_->missing; }
const std::string& LoadedFrame::schema() const noexcept { return data_->schema; }
const std::vector<std::string>& LoadedFrame::views() const noexcept { return data_->views; }
const std::string& LoadedFrame::view() const noexcept { return data_->view; }
const std::vector<std::string>& LoadedFrame::assumptions() const noexcept { return data_->assumptions; }

}  // namespace stein::exr
