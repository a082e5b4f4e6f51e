#include "sample_maps.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/material_maps/cluster_encoder.h>
#include <hshfit/material_maps/map_writer.h>
#include <hshfit/material_maps/texel_encoder.h>

#include <filesystem>
#include <random>

namespace hshfit::test {
namespace {

class NoiseTexels final : public TexelSource {
public:
    NoiseTexels(const TexelLayout& layout, std::size_t width, std::size_t height)
        : layout_(layout), width_(width), height_(height) {}

    std::size_t width() const override { return width_; }
    std::size_t height() const override { return height_; }
    const TexelLayout& layout() const override { return layout_; }
    std::unique_ptr<TexelBand> band(std::size_t, std::size_t) override {
        return std::make_unique<Band>(*this);
    }

private:
    struct Band final : TexelBand {
        explicit Band(const NoiseTexels& of) : source(of) {}
        void texels(std::size_t row, std::size_t column, std::size_t count,
                    float* out) const override {
            for (std::size_t t = 0; t < count; ++t)
                source.fill(row, column + t, out), out += source.layout_.floats();
        }
        const NoiseTexels& source;
    };
    void fill(std::size_t row, std::size_t column, float* out) const {
        std::mt19937 random(static_cast<std::uint32_t>(1 + row * width_ + column));
        std::uniform_real_distribution<float> uniform(-1, 1);
        const std::size_t used = layout_.channels * layout_.slots.size();
        for (std::size_t k = 0; k < layout_.floats(); ++k)
            out[k] = k % layout_.stride() < used ? uniform(random) : 0;
    }
    const TexelLayout& layout_;
    std::size_t width_, height_;
};

/// The encoder, and what it shares.
std::unique_ptr<TexelEncoder> encoderOf(const SampleMap& sample, TexelSource& texels,
                                        MapSidecar& sidecar, Processes& alone) {
    const TexelLayout& layout = sidecar.layout;
    if (sample.form == "outgoing") return std::make_unique<PlainEncoder>(layout, sample.number);
    const std::vector<float> samples = sampleTexels(texels, sample.width * sample.height, alone);
    const LowRank lowRank = PrincipalShapes(layout, samples, alone).lowRank(sample.rank);
    sidecar.shapes = lowRank.shapes();
    if (sample.form == "low-rank") return std::make_unique<LowRankEncoder>(lowRank, sample.number);
    const LevelSamples levels = sampleLevels(texels, lowRank, samples, sidecar.levels, 64, alone);
    return std::make_unique<ClusterEncoder>(
        lowRank, levels,
        ClusterEncoder::Options{.clusters = sample.clusters, .levels = sidecar.levels.size()},
        alone);
}

}  // namespace

std::vector<SampleMap> sampleMaps() {
    return {
        {.name = "outgoing, elevations"},
        {.name = "outgoing, grey, parabolic map, SH",
         .basis = "sh",
         .order = 3,
         .outgoing = "4x6",
         .grey = true,
         .mirror = false,
         .number = gpu::Number::float32,
         .width = 8},
        {.name = "outgoing, one direction", .outgoing = "30,0", .mirror = false},
        {.name = "low-rank, elevations", .form = "low-rank", .width = 12, .height = 20},
        {.name = "low-rank, grey, parabolic map, f cos",
         .form = "low-rank",
         .basis = "zernike",
         .order = 3,
         .outgoing = "4x4",
         .grey = true,
         .mirror = false,
         .quantity = Quantity::brdfCosine,
         .rank = 3},
        {.name = "clusters", .form = "clusters"},
        {.name = "clusters, repeated",
         .form = "clusters",
         .width = 4,
         .height = 32,
         .rank = 4,
         .clusters = 300,
         .wrap = Wrap::repeat},
    };
}

std::unique_ptr<MaterialMap> writeSampleMap(const SampleMap& sample, const std::string& folder) {
    const auto basis = bases::make(sample.basis, sample.order);
    MapSidecar sidecar{.form = sample.form,
                       .texture = "material.ktx2",
                       .basis = sample.basis,
                       .order = sample.order,
                       .quantity = sample.quantity,
                       .channels = sample.grey ? Channels::grey() : Channels::rgb(),
                       .isotropic = sample.mirror,
                       .bilateral = sample.mirror,
                       .levels = levelSizes(sample.width, sample.height),
                       .source = "noise",
                       .generator = "test"};
    sidecar.layout = texelLayout(*basis, OutgoingSet::parse(sample.outgoing),
                                 sidecar.channels.count(), sample.mirror);
    Processes alone;
    NoiseTexels texels(sidecar.layout, sample.width, sample.height);
    const auto encoder = encoderOf(sample, texels, sidecar, alone);
    sidecar.number = encoder->number();
    const std::string path = (std::filesystem::path(folder) / "material.ktx2").string();
    writeFile(path, "");
    LevelFile file(path, encoder->number(), encoder->layers(), sidecar.levels);
    const BandPlan plan = planBands(sidecar.levels, file.bytesOfTexel(), std::size_t{1} << 24);
    writeMap(texels, *encoder, file, plan, alone);
    const auto centres = encoder->centres();
    sidecar.centres.assign(centres.begin(), centres.end());
    const std::string json = (std::filesystem::path(folder) / "material.json").string();
    writeFile(json, toText(sidecar));
    return std::make_unique<MaterialMap>(json);
}

}  // namespace hshfit::test
