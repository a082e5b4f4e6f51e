#include "places.h"

namespace hshfit::test {

std::string sharedFolder() {
    return HSHFIT_SHARED;
}

std::string sourceFolder() {
    return HSHFIT_SOURCE;
}

std::string program() {
    return HSHFIT_PROGRAM;
}

}  // namespace hshfit::test
