// Slices from MERL `.slice` files and from pictures.

#include <brdfs/measured/gridded/slice.h>
#include <brdfs/measured/no_values.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_header.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/printable.h>

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

namespace hshfit::brdfs {

static_assert(std::endian::native == std::endian::little, ".slice files are little-endian");

namespace {

constexpr std::size_t merlNodes = 90;
constexpr std::size_t merlSliceBytes = merlNodes * merlNodes * 3 * sizeof(float);
constexpr std::size_t mostValues = std::size_t{1} << 26;
constexpr std::size_t mostSlices = 360;

std::string_view textOf(std::span<const unsigned char> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The wavelength of a channel such as "550nm" or "550,5nm" (a point would separate layers).
std::optional<double> wavelengthOf(std::string name) {
    if (!name.ends_with("nm")) return std::nullopt;
    name.resize(name.size() - 2);
    std::ranges::replace(name, ',', '.');
    std::string_view text = name;
    double value = 0;
    if (!takeNumber(text, value) || !text.empty() || !(value > 0) || !std::isfinite(value)) {
        return std::nullopt;
    }
    return value;
}

/// The colour channels of the first slice and their names in the picture.
struct Colours {
    Channels channels;
    std::vector<std::string> names;
};

Colours coloursOf(const ExrPicture& picture, const std::string& file) {
    const auto has = [&](std::string_view name) {
        return std::ranges::find(picture.channels, name) != picture.channels.end();
    };
    if (has("R") && has("G") && has("B")) return {Channels::rgb(), {"R", "G", "B"}};
    std::map<double, std::string> byWavelength;
    for (const std::string& name : picture.channels) {
        if (const auto wavelength = wavelengthOf(name)) byWavelength[*wavelength] = name;
    }
    if (!byWavelength.empty()) {
        std::vector<double> wavelengths;
        std::vector<std::string> names;
        for (const auto& [wavelength, name] : byWavelength) {
            wavelengths.push_back(wavelength);
            names.push_back(name);
        }
        return {Channels::spectral(std::move(wavelengths)), std::move(names)};
    }
    if (has("Y")) return {Channels::grey(), {"Y"}};
    throw InputError(
        fmt::format("{}: has neither channels R, G, B nor Y nor wavelengths ('550nm')", file));
}

std::string attributeOf(const ExrPicture& picture, const std::string& name,
                        const std::string& file) {
    const auto found = picture.attributes.find(name);
    if (found == picture.attributes.end()) {
        throw InputError(fmt::format("{}: has no string attribute '{}'", file, name));
    }
    return found->second;
}

/// The azimuths that the attribute lists, the first of them without a layer name.
std::vector<double> phiOf(const ExrPicture& picture, double period, const std::string& file) {
    const std::string listed = attributeOf(picture, "hshfit:phi_difference", file);
    std::vector<double> phi;
    std::string_view text = listed;
    for (;;) {
        while (text.starts_with(' ')) text.remove_prefix(1);
        if (text.empty()) break;
        double value = 0;
        if (!takeNumber(text, value) || !(value >= 0) || !(value < period) ||
            phi.size() == mostSlices) {
            throw InputError(fmt::format(
                "{}: the attribute 'hshfit:phi_difference' has to list at most {} numbers from 0 "
                "to below {}",
                file, mostSlices, period));
        }
        phi.push_back(value);
    }
    std::vector<double> sorted = phi;
    std::ranges::sort(sorted);
    if (phi.empty() || std::ranges::adjacent_find(sorted) != sorted.end()) {
        throw InputError(fmt::format(
            "{}: the attribute 'hshfit:phi_difference' is empty or names a number twice", file));
    }
    return phi;
}

/// Channel indices: [slice][colour].
std::vector<std::vector<std::size_t>> channelIndices(const ExrPicture& picture,
                                                     const Colours& colours,
                                                     const std::vector<double>& phi,
                                                     const std::string& file) {
    std::vector<std::vector<std::size_t>> indices;
    for (std::size_t i = 0; i < phi.size(); ++i) {
        indices.emplace_back();
        for (const std::string& name : colours.names) {
            const std::string full = i == 0 ? name : sliceLayerName(phi[i]) + "." + name;
            const auto found = std::ranges::find(picture.channels, full);
            if (found == picture.channels.end()) {
                throw InputError(fmt::format("{}: has no channel '{}'", file, printable(full)));
            }
            indices.back().push_back(static_cast<std::size_t>(found - picture.channels.begin()));
        }
    }
    return indices;
}

}  // namespace

std::string sliceLayerName(double phi) {
    std::string name = fmt::format("phi{:0>3}", fmt::format("{}", phi));
    std::ranges::replace(name, '.', ',');
    return name;
}

std::unique_ptr<SliceBrdf> readMerlSlice(std::span<const unsigned char> bytes,
                                         const std::string& name) {
    if (bytes.size() != merlSliceBytes) {
        throw InputError(
            fmt::format("{}: the file has {} bytes, expected {} for 90 x 90 float32 "
                        "values of R, G and B",
                        name, bytes.size(), merlSliceBytes));
    }
    std::vector<float> stored(merlSliceBytes / sizeof(float));
    std::memcpy(stored.data(), bytes.data(), bytes.size());
    SliceLayout layout{.halfCount = merlNodes,
                       .differenceCount = merlNodes,
                       .rootHalf = true,
                       .shift = 0,
                       .phi = {90}};
    return std::make_unique<SliceBrdf>(std::move(layout), Channels::rgb(), std::move(stored), name,
                                       "merl-slice");
}

std::unique_ptr<SliceBrdf> readSlicePicture(std::span<const unsigned char> bytes,
                                            const std::string& name) {
    if (exrSaysCoefficients(textOf(bytes))) {
        throw InputError(name + ": holds coefficients, not slices of a BRDF");
    }
    const ExrPicture picture = readExrPicture(textOf(bytes), name, mostValues);
    SliceLayout layout{.halfCount = picture.width,
                       .differenceCount = picture.height,
                       .phi = {90},
                       .stated = picture.attributes.contains("hshfit:slices")};
    std::vector<double> phi = layout.phi;
    if (layout.stated) {
        const std::string version = attributeOf(picture, "hshfit:slices", name);
        const std::string columns = attributeOf(picture, "hshfit:theta_half", name);
        const std::string period = attributeOf(picture, "hshfit:phi_period", name);
        if (version != "1" || (columns != "linear" && columns != "root") ||
            (period != "180" && period != "360")) {
            throw InputError(fmt::format(
                "{}: hshfit:slices is '{}', hshfit:theta_half '{}', hshfit:phi_period '{}'; "
                "expected 1, linear or root, 180 or 360",
                name, printable(version), printable(columns), printable(period)));
        }
        layout.rootHalf = columns == "root";
        layout.period = period == "180" ? 180 : 360;
        phi = phiOf(picture, layout.period, name);
        layout.phi = phi;
        std::ranges::sort(layout.phi);
    }
    const Colours colours = coloursOf(picture, name);
    const auto indices = channelIndices(picture, colours, phi, name);
    std::vector<float> stored;
    stored.reserve(layout.nodes() * colours.names.size());
    for (const double angle : layout.phi) {
        const auto plane = std::ranges::find(phi, angle) - phi.begin();
        for (std::size_t row = picture.height; row-- > 0;) {
            for (std::size_t column = 0; column < picture.width; ++column) {
                for (const std::size_t channel : indices[static_cast<std::size_t>(plane)]) {
                    stored.push_back(picture.at(row, column, channel));
                }
            }
        }
    }
    return std::make_unique<SliceBrdf>(std::move(layout), colours.channels, std::move(stored), name,
                                       "slices");
}

namespace {

template <std::unique_ptr<SliceBrdf> (*read)(std::span<const unsigned char>, const std::string&)>
std::unique_ptr<Brdf> openSlice(const std::string& path, const Parameters&) {
    const MappedFile file(path);
    try {
        auto brdf = read(file.bytes(), path);
        file.checkIntact();
        refuseWithoutValues(brdf->census(), path);
        return brdf;
    } catch (const InputError&) {
        file.checkIntact();  // reports a file that was removed or cut while it was read
        throw;
    }
}

}  // namespace

const Format& merlSliceFormat() {
    static const Format format{
        .name = "merl-slice",
        .help = "the plane phi_d = 90 degrees of a MERL table, isotropic, RGB",
        .extension = ".slice",
        .recognises = [](std::span<const unsigned char>,
                         std::uint64_t fileSize) { return fileSize == merlSliceBytes; },
        .parameters = {},
        .open = openSlice<readMerlSlice>,
    };
    return format;
}

const Format& slicesFormat() {
    static const Format format{
        .name = "slices",
        .help = "OpenEXR picture over theta_h and theta_d, isotropic, RGB, grey or spectral",
        .extension = ".exr",
        .recognises = [](std::span<const unsigned char> head,
                         std::uint64_t) { return hasExrMagic(textOf(head)); },
        .parameters = {},
        .open = openSlice<readSlicePicture>,
    };
    return format;
}

}  // namespace hshfit::brdfs
