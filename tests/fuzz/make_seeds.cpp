// make_seeds FOLDER: FOLDER/fuzz_NAME with small synthetic inputs for each target to start from.

#include <hshfit/output/coefficient_file.h>

#include <brdfs/tensor_writer.h>
#include <lib/coefficient_samples.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

namespace {

using hshfit::test::put;
using hshfit::test::RglShape;

void write(const std::filesystem::path& path, const std::string& bytes) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

RglShape small(std::vector<float> phi, std::uint64_t channels, bool jacobian) {
    return {.phi = std::move(phi),
            .theta = {0.0F, 1.5F},
            .normalRows = 2,
            .normalColumns = 3,
            .colourRows = 2,
            .colourColumns = 2,
            .channels = channels,
            .jacobian = jacobian};
}

std::string merlScript(std::int32_t azimuths, std::uint8_t length, std::uint8_t mode, double bad) {
    std::string bytes;
    for (const std::int32_t size : {90, 90, azimuths}) put(bytes, size);
    put(bytes, length);
    put(bytes, mode);
    for (const std::uint32_t cell : {0u, 500000u, 1457999u, 2000000u, 4373999u}) {
        put(bytes, cell);
        put(bytes, cell % 1000 == 0 ? bad : 1.5);
    }
    return bytes;
}

void coefficientFiles(const std::filesystem::path& folder) {
    using namespace hshfit;
    std::filesystem::create_directories(folder);
    int number = 0;
    for (const OutgoingSet& outgoing :
         {OutgoingSet::direction(1, 2), OutgoingSet::elevations(3), OutgoingSet::parabolic(4, 5)}) {
        for (const Channels& channels : samples::allChannels()) {
            const auto c = samples::make(outgoing, channels, Quantity::brdf, 2, 1);
            writeCoefficients(c, folder / (std::to_string(number) + ".json"));
            writeCoefficients(c, folder / (std::to_string(number++) + ".exr"));
        }
    }
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "usage: make_seeds FOLDER\n");
        return 2;
    }
    const std::filesystem::path folder = arguments[1];
    coefficientFiles(folder / "fuzz_coefficients");
    int number = 0;
    for (const std::vector<float>& phi :
         {std::vector<float>{0}, {0, 1}, {-3.1415927F, -1.5707964F, 0}, {0, 0.5F, 1.5707964F}}) {
        for (const std::uint64_t channels : {3, 2}) {
            for (const bool jacobian : {true, false}) {
                write(folder / "fuzz_rgl" / std::to_string(number++),
                      tensorFile(rglFields(small(phi, channels, jacobian))));
            }
        }
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (std::uint8_t mode = 0; mode < 4; ++mode) {
        write(folder / "fuzz_merl" / std::to_string(number++), merlScript(180, 0, mode, -1));
        write(folder / "fuzz_merl" / std::to_string(number++), merlScript(360, 1, mode, nan));
        write(folder / "fuzz_merl" / std::to_string(number++), merlScript(180, 230, mode, 2));
    }
}
