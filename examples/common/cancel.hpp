// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stein::cli {

/// From now on the first SIGINT or SIGTERM only raises a flag; a second one of the same kind ends the program at once.
void catch_interrupts();

[[nodiscard]] bool interrupted() noexcept;

/// @throws Error kCancelled if interrupted.
void check_not_interrupted();

}  // namespace stein::cli
