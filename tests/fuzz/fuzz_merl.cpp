// A MERL file has one of two sizes, both too large to be mutated: the bytes are a script that makes
// one. 12 bytes of header, one octet that picks the length (one of the right ones, or a few bytes
// on either side), one for the interpolation, then patches of 12 bytes: u32 cell, f64 value. The
// rest of the file is a hole, that is zeros.

#include <brdfs/measured/merl.h>
#include <hshfit/error.h>

#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

using hshfit::brdfs::MerlBrdf;
using hshfit::brdfs::MerlInterpolation;
using hshfit::brdfs::MerlLayout;

const std::string& scratchPath() {
    static const std::string path = [] {
        std::string name = "/dev/shm/hshfit-fuzz-merl-XXXXXX";
        const int descriptor = mkstemp(name.data());
        if (descriptor < 0) std::abort();
        close(descriptor);
        return name;
    }();
    static const int removed = std::atexit([] { unlink(scratchPath().c_str()); });
    static_cast<void>(removed);
    return path;
}

std::size_t lengthOf(std::uint8_t choice) {
    const std::size_t right = MerlLayout{.azimuthCount = choice % 2 == 0 ? 180u : 360u}.fileBytes();
    if (choice < 200) return right;
    return choice < 228 ? choice - 200u : right + 14 - (choice - 228u);
}

/// Writes what the script says and returns which cells it wrote to.
std::vector<std::uint32_t> writeScript(const std::uint8_t* data, std::size_t size) {
    const int descriptor = open(scratchPath().c_str(), O_RDWR | O_TRUNC);
    const std::size_t length = lengthOf(data[12]);
    std::vector<std::uint32_t> cells;
    if (ftruncate(descriptor, static_cast<off_t>(length)) != 0 ||
        pwrite(descriptor, data, std::min<std::size_t>(12, length), 0) < 0) {
        std::abort();
    }
    for (std::size_t at = 14; at + 12 <= size && cells.size() < 16; at += 12) {
        std::uint32_t cell;
        std::memcpy(&cell, data + at, sizeof cell);
        const std::size_t offset = MerlLayout::headerBytes + 8 * std::size_t{cell};
        if (offset + 8 > length) continue;
        if (pwrite(descriptor, data + at + 4, 8, static_cast<off_t>(offset)) != 8) std::abort();
        cells.push_back(cell);
    }
    close(descriptor);
    return cells;
}

void evaluateAround(const MerlBrdf& brdf, std::uint32_t cell) {
    const std::size_t azimuths = brdf.layout().azimuthCount;
    const std::size_t inPlane = cell % brdf.layout().cells(), row = inPlane / azimuths;
    for (const double shift : {-0.7, -0.2, 0.0, 0.3, 0.8}) {
        const auto pair = hshfit::brdfs::merlDirections(
            static_cast<double>(row / 90) + shift, static_cast<double>(row % 90) + shift,
            static_cast<double>(inPlane % azimuths) + shift);
        for (const double f : hshfit::evaluate(brdf, pair.wi, pair.wo)) {
            if (!(f >= 0) || !std::isfinite(f)) std::abort();
        }
        // A lobe touches 270 pages.
        if (shift == 0 && cell % 4 == 0) brdf.lobes(pair.wo);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 14) return 0;
    const std::vector<std::uint32_t> cells = writeScript(data, size);
    try {
        const MerlBrdf brdf(scratchPath(), data[13] % 2 == 0 ? MerlInterpolation::linear
                                                             : MerlInterpolation::nearest);
        for (const std::uint32_t cell : cells) evaluateAround(brdf, cell);
        // Every other file is cut off while it is mapped.
        if (data[13] % 4 >= 2 && truncate(scratchPath().c_str(), 4096) == 0) {
            for (const std::uint32_t cell : cells) evaluateAround(brdf, cell);
        }
        brdf.checkIntact();
    } catch (const hshfit::InputError&) {
    }
    return 0;
}
