#include <hshfit/brdf/channels.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::inline brdf {
namespace {

std::string nanometres(double wavelength) {
    return fmt::format("{}nm", wavelength);
}

}  // namespace

std::size_t Channels::count() const {
    switch (kind) {
        case Kind::grey:
            return 1;
        case Kind::rgb:
            return 3;
        case Kind::spectral:
            break;
        case Kind::named:
            return quantities.size() * std::max<std::size_t>(wavelengths.size(), 1);
    }
    return wavelengths.size();
}

std::vector<std::string> Channels::names() const {
    switch (kind) {
        case Kind::grey:
            return {"grey"};
        case Kind::rgb:
            return {"R", "G", "B"};
        case Kind::named:
            if (wavelengths.empty()) return quantities;
            break;
        case Kind::spectral:
            break;
    }
    std::vector<std::string> names;
    for (const std::string& quantity : quantities)
        for (const double each : wavelengths) names.push_back(quantity + "_" + nanometres(each));
    if (kind == Kind::spectral)
        for (const double each : wavelengths) names.push_back(nanometres(each));
    return names;
}

std::size_t Channels::reflectances() const {
    if (kind != Kind::named) return count();
    return !quantities.empty() && quantities.front() == "m00" ? count() / quantities.size() : 0;
}

bool Channels::serve(const Channels& whole) const {
    return *this == whole || (kind == Kind::grey && whole.kind != Kind::named);
}

}  // namespace hshfit::inline brdf
