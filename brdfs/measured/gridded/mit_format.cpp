// The header of an MIT file, and the facts about its values.

#include <brdfs/measured/gridded/mit.h>
#include <brdfs/measured/no_values.h>
#include <hshfit/checked_product.h>
#include <hshfit/error.h>

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

namespace hshfit::brdfs {

static_assert(std::endian::native == std::endian::little, "MIT files are little-endian");

namespace {

using Header = std::array<std::int32_t, 16>;

Header headerOf(std::span<const unsigned char> bytes) {
    Header header;
    std::memcpy(header.data(), bytes.data(), sizeof header);
    return header;
}

static_assert(checkedProduct({MitLayout::mostBins, MitLayout::mostBins, MitLayout::mostBins,
                              MitLayout::mostBins, 3 * sizeof(float)}));

bool isBinCount(std::int32_t value) {
    return value >= 1 && value <= static_cast<std::int32_t>(MitLayout::mostBins);
}

MitLayout layoutOf(const Header& header) {
    const auto at = [&header](std::size_t i) { return static_cast<std::size_t>(header[i]); };
    return {.thetaIn = at(0),
            .thetaOut = at(1),
            .phiDifference = at(2),
            .phiIn = at(3),
            .half = header[9] == 1};
}

MitLayout checkedLayout(std::span<const unsigned char> bytes, const std::string& file) {
    if (bytes.size() < MitLayout::headerBytes) {
        throw InputError(fmt::format(
            "{}: {} bytes are too few for the 64-byte header of an MIT anisotropic file", file,
            bytes.size()));
    }
    const Header header = headerOf(bytes);
    const auto require = [&](std::size_t i, bool valid, std::string_view what,
                             std::string_view expected) {
        if (valid) return;
        throw InputError(fmt::format("{}: header[{}] ({}, offset {}) is {}, expected {}", file, i,
                                     what, 4 * i, header[i], expected));
    };
    constexpr const char* names[] = {"bins in theta_in", "bins in theta_out", "bins in phi_diff",
                                     "bins in phi_in"};
    for (std::size_t i = 0; i < 4; ++i) require(i, isBinCount(header[i]), names[i], "1 to 4096");
    require(6, header[6] == 1, "parametrisation", "1 (standard)");
    require(7, header[7] == 0, "binning", "0 (uniform)");
    require(9, header[9] == 0 || header[9] == 1, "half data", "0 or 1");
    require(10, header[10] == 3, "channels", "3");
    const MitLayout layout = layoutOf(header);
    if (bytes.size() != layout.fileBytes()) {
        throw InputError(fmt::format(
            "{}: the file has {} bytes, expected {} for {} x {} x {} x {} bins in three channels",
            file, bytes.size(), layout.fileBytes(), layout.thetaIn, layout.thetaOut,
            layout.phiDifference, layout.phiIn));
    }
    return layout;
}

// The fields with a single valid value decide; errors in other fields are reported by the reader.
bool looksLikeMit(std::span<const unsigned char> head, std::uint64_t) {
    if (head.size() < MitLayout::headerBytes) return false;
    const Header header = headerOf(head);
    return header[6] == 1 && header[7] == 0 && header[10] == 3 &&
           std::all_of(header.begin(), header.begin() + 4, isBinCount);
}

/// Whether a bin has no mark. Stops at the first one.
bool hasValues(std::span<const unsigned char> bytes) {
    for (std::size_t at = MitLayout::headerBytes; at + sizeof(float) <= bytes.size();
         at += sizeof(float)) {
        float value;
        std::memcpy(&value, bytes.data() + at, sizeof value);
        if (!(value < 0)) return true;
    }
    return false;
}

}  // namespace

MitBrdf::MitBrdf(std::span<const unsigned char> bytes, std::string name, double scale)
    : bytes_(bytes), name_(std::move(name)), layout_(checkedLayout(bytes, name_)), scale_(scale) {}

std::unique_ptr<MitBrdf> MitBrdf::open(const std::string& path, double scale) {
    auto file = std::make_unique<MappedFile>(path);
    auto brdf = std::make_unique<MitBrdf>(file->bytes(), path, scale);
    if (!hasValues(file->bytes())) refuseWithoutValues(brdf->census(), path);
    brdf->file_ = std::move(file);
    return brdf;
}

std::string MitBrdf::name() const {
    return scale_ == 1 ? name_ : fmt::format("{}:scale={}", name_, scale_);
}

std::vector<Fact> MitBrdf::facts() const {
    return {{"format", "mit"},
            {"dimensions", fmt::format("{} x {} x {} x {}", layout_.thetaIn, layout_.thetaOut,
                                       layout_.phiDifference, layout_.phiIn)},
            {"half_of_phi_difference", layout_.half},
            {"cells", static_cast<std::int64_t>(layout_.cells())},
            {"scale", scale_}};
}

Census MitBrdf::census() const {
    Census census;
    census.values = 3 * layout_.cells();
    constexpr std::size_t blockSize = 16384;
    std::vector<float> block(blockSize);
    for (std::size_t begin = 0; begin < census.values; begin += blockSize) {
        const std::size_t count = std::min(blockSize, census.values - begin);
        std::memcpy(block.data(), bytes_.data() + MitLayout::headerBytes + begin * sizeof(float),
                    count * sizeof(float));
        for (std::size_t i = 0; i < count; ++i) {
            const float value = block[i];
            if (value < 0 && value >= std::numeric_limits<float>::lowest()) {
                ++census.invalid;
            } else {
                census.add(scale_ * static_cast<double>(value));
            }
        }
    }
    return census;
}

std::vector<Axis> MitBrdf::axes() const {
    const auto axis = [](const char* name, std::size_t bins, double range) {
        const double step = range / static_cast<double>(bins);
        return Axis{name, "degrees", bins, step / 2, range - step / 2, step};
    };
    return {axis("theta_i", layout_.thetaIn, 90), axis("theta_o", layout_.thetaOut, 90),
            axis("phi_difference", layout_.phiDifference, layout_.half ? 180 : 360),
            axis("phi_i", layout_.phiIn, 360)};
}

void MitBrdf::checkReadable() const {
    if (file_) file_->checkIntact();
}

void MitBrdf::checkIntact() const {
    checkReadable();
    const std::int64_t corrupt = corrupt_.load(std::memory_order_relaxed);
    if (corrupt < 0) return;
    const auto index = static_cast<std::size_t>(corrupt);
    const std::size_t channel = index / layout_.cells(), cell = index % layout_.cells();
    const std::size_t row = cell / layout_.phiIn, pair = row / layout_.phiDifference;
    throw InputError(fmt::format(
        "{}: bin (theta_in {}, theta_out {}, phi_diff {}, phi_in {}) of channel {}, offset {}, "
        "is {}, expected a finite number",
        name_, pair / layout_.thetaOut, pair % layout_.thetaOut, row % layout_.phiDifference,
        cell % layout_.phiIn, "RGB"[channel], MitLayout::headerBytes + index * sizeof(float),
        raw(channel, cell)));
}

const Format& mitFormat() {
    static const Format format{
        .name = "mit",
        .help = "MIT table of two directions, anisotropic, RGB",
        .extension = ".dat",
        .recognises = looksLikeMit,
        .parameters = {{.name = "scale",
                        .help = "f in 1/sr of a stored 1",
                        .kind = Parameter::Kind::number,
                        .fallback = 1,
                        .min = 1e-12,
                        .max = 1e12}},
        .open = [](const std::string& path, const Parameters& parameters) -> std::unique_ptr<Brdf> {
            return MitBrdf::open(path, parameters.number("scale"));
        },
    };
    return format;
}

}  // namespace hshfit::brdfs
