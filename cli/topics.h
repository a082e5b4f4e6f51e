#pragma once

#include "page.h"

#include <span>

namespace hshfit::cli {

/// A page of help that belongs to no command.
struct Topic {
    const char* name;
    const char* help;  ///< one line
    Page (*page)();    ///< without a title
};

std::span<const Topic> topics();

}  // namespace hshfit::cli
