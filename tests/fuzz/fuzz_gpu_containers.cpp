// The bytes are a file of an export: a container that holds its sidecar, a DDS, else a sidecar.

#include <hshfit/error.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/containers/sidecar.h>
#include <hshfit/gpu/proposals/proposal_record.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace {

using namespace hshfit::gpu;

/// A file that reads has the sizes that it states, and its tests agree (readTexelFile throws
/// otherwise).
void check(const Payload& payload) {
    if (payload.coefficients.bytes.size() !=
        payload.coefficients.count() * numberBytes(payload.coefficients.number)) {
        std::abort();
    }
    const hshfit::Coefficients c = unpack(payload);
    if (c.values.size() != c.outgoing.size() * c.channels.count() * c.slots()) std::abort();
}

/// The second step as well, with texels of zeros in the place of a file, while they are small.
void readSidecar(std::string_view text) {
    parseProposal(text, "input");
    SidecarIndex index = parseSidecarIndex(text, "input");
    constexpr std::size_t most = 1 << 16;
    const auto fill = [](Texels& texels) {
        texels.bytes.assign(texels.count() * numberBytes(texels.number), std::byte{0});
    };
    if (index.coefficients.count() > most) return;
    if (index.basisTexels && index.basisTexels->count() > most) return;
    fill(index.coefficients);
    if (index.basisTexels) fill(*index.basisTexels);
    std::vector<TestTriple> tests;
    const Payload payload = parseSidecar(text, "input", std::move(index), tests);
    check(payload);
    largestDifference(payload, tests);
}

void read(std::string_view bytes) {
    for (const Container& container : containers::catalog()) {
        if (!container.recognises(bytes)) continue;
        if (container.holdsSidecar) {
            check(readTexelFile(bytes, container, "input").payload);
            return;
        }
        const Texels expected{8, 8, 3, Number::float16, {}, {}};
        if (container.texels(bytes, Role::coefficients, expected, "input").size() != 1536) {
            std::abort();
        }
        return;
    }
    readSidecar(bytes);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        read({reinterpret_cast<const char*>(data), size});
    } catch (const hshfit::InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    }
    return 0;
}
