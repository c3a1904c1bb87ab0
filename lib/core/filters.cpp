// SPDX-License-Identifier: Apache-2.0
#include "stein/filters.hpp"
