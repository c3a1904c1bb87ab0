// SPDX-License-Identifier: Apache-2.0
//
// How a file was perturbed, in its header: so that whoever reads what a denoiser made of it need not be told.
#pragma once

#include <ImfHeader.h>

#include "stein/candidate.hpp"

namespace stein::exr {

/// The seed as a text, since no attribute holds 64 bits.
void insert_perturbation(const Perturbation& perturbation, Imf::Header& header);

}  // namespace stein::exr
