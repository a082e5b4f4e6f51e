#include <hshfit/brdf/channels.h>

#include <fmt/format.h>

namespace hshfit::inline brdf {

std::size_t Channels::count() const {
    switch (kind) {
        case Kind::grey:
            return 1;
        case Kind::rgb:
            return 3;
        case Kind::spectral:
            break;
    }
    return wavelengths.size();
}

std::vector<std::string> Channels::names() const {
    switch (kind) {
        case Kind::grey:
            return {"grey"};
        case Kind::rgb:
            return {"R", "G", "B"};
        case Kind::spectral:
            break;
    }
    std::vector<std::string> names;
    for (double wavelength : wavelengths) names.push_back(fmt::format("{}nm", wavelength));
    return names;
}

}  // namespace hshfit::inline brdf
