#pragma once

// Payloads of every kind, and folders of exported files, for the tests of containers.

#include <gpu/asymmetric.h>
#include <lib/coefficient_files/coefficient_samples.h>

#include <hshfit/gpu/containers/containers.h>

#include <string>
#include <vector>

namespace hshfit::test {

struct Sample {
    std::string what;
    gpu::Payload payload;
};

/// Every map, channel kind, packing, basis and option, small.
inline std::vector<Sample> samplePayloads(gpu::Number number) {
    using samples::asymmetric;
    const auto rgb = Channels::rgb();
    std::vector<Sample> result;
    const auto add = [&](std::string what, const Coefficients& c, gpu::PackOptions options) {
        options.number = number;
        result.push_back({std::move(what), gpu::pack(c, options)});
    };
    add("map", asymmetric("hsh", 4, OutgoingSet::parabolic(12, 8), rgb, 1), {});
    add("unmarked map, odd", asymmetric("hsh", 3, OutgoingSet::parabolic(5, 9), rgb, 2), {});
    add("elevations", asymmetric("hsh", 5, OutgoingSet::elevations(7), rgb, 3, true), {});
    add("direction", asymmetric("hsh", 3, OutgoingSet::direction(0.6, -1.1), rgb, 4), {});
    add("grey", asymmetric("esh", 4, OutgoingSet::parabolic(8, 8), Channels::grey(), 5), {});
    add("spectral",
        asymmetric("zernike", 3, OutgoingSet::elevations(3),
                   Channels::spectral({400, 500.5, 550, 600, 700}), 6),
        {});
    add("rgb packing", asymmetric("makhotkin-flux", 3, OutgoingSet::parabolic(9, 8), rgb, 7),
        {.packing = gpu::Packing::rgb});
    add("chroma", asymmetric("sh", 4, OutgoingSet::parabolic(8, 8), rgb, 8),
        {.luminanceChroma = true, .chromaOrder = 2});
    add("basis textures", asymmetric("h-basis", 3, OutgoingSet::parabolic(8, 8), rgb, 9),
        {.basisSize = 16});
    Coefficients cosine = asymmetric("hsh", 3, OutgoingSet::elevations(4), rgb, 10);
    cosine.quantity = Quantity::brdfCosine;
    cosine.bilateral = cosine.reciprocal = true;
    cosine.source = "*/ \"quoted\" \\ /* 100 µm </script>";
    cosine.energy = {0, 0, false, "it diverges"};
    for (std::size_t i = 0; i < cosine.values.size(); ++i) {  // no sines: half of the slots
        const int slot = static_cast<int>(i % cosine.slots());
        if (slot == 1 || slot == 4 || slot == 5) cosine.values[i] = 0;
    }
    add("cosines only", cosine, {});
    return result;
}

/// Writes into `folder` with the containers named (all that hold the number, if none is).
inline std::vector<gpu::ExportedFile> exportTo(const std::string& folder,
                                               const gpu::Payload& payload,
                                               const std::vector<std::string>& names = {},
                                               const gpu::ExportOptions& options = {},
                                               const std::string& name = "sample") {
    std::vector<const gpu::Container*> chosen;
    for (const std::string& wanted : names) chosen.push_back(&gpu::findContainer(wanted));
    for (const gpu::Container& container : gpu::containers::catalog()) {
        if (names.empty() && container.holds(payload.coefficients.number)) {
            chosen.push_back(&container);
        }
    }
    FileSet files(folder, true);
    auto written = gpu::writeContainers(payload, chosen, name, options, files);
    files.commit();
    return written;
}

inline const gpu::Number numbers[] = {gpu::Number::float16, gpu::Number::float32,
                                      gpu::Number::unorm16, gpu::Number::unorm8};

}  // namespace hshfit::test
