#pragma once

#include <jobs/bounds.h>

#include <CLI/CLI.hpp>

namespace hshfit::cli {

/// The check of an option whose bounds other front ends have too.
template <class Number>
CLI::Range within(const jobs::Bounds<Number>& bounds) {
    return CLI::Range(bounds.least, bounds.most);
}

}  // namespace hshfit::cli
