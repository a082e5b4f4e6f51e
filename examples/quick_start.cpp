// From a measured file, or any other BRDF, to coefficients: quick_start BRDF OUT.json
#include <brdfs/catalog.h>
#include <hshfit/hshfit.h>

#include <cstdio>

int main(int argc, char** argv) try {
    if (argc != 3) throw hshfit::UsageError("usage: quick_start BRDF OUT.json");
    const auto brdf = hshfit::brdfs::open(argv[1]);
    const auto basis = hshfit::bases::make("hsh", 7);
    const auto outgoing = hshfit::OutgoingSet::parabolic(32, 32);
    const hshfit::ProjectionOptions options = {.quantity = hshfit::Quantity::brdfCosine};
    const auto result = hshfit::project(*brdf, *basis, outgoing, options);
    hshfit::writeCoefficients(result.coefficients, argv[2]);
    std::printf("%.4f\n", hshfit::capturedShare(result).value_or(0));
} catch (const hshfit::Error& error) {
    std::fprintf(stderr, "quick_start: %s\n", error.what());
    return static_cast<int>(error.code());
}
