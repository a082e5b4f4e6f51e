// The library in one page: open a BRDF, project it, measure the error, write the coefficients.
//     project_example SPEC OUT.json       for example: project_example ward:ax=.2,ay=.5 ward.json

#include <brdfs/catalog.h>
#include <fmt/format.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/error.h>
#include <hshfit/projection/one_basis.h>

int main(int argc, char** argv) try {
    if (argc != 3) throw hshfit::UsageError("usage: project_example SPEC OUT.json");

    const auto brdf = hshfit::brdfs::open(argv[1]);
    const auto basis = hshfit::bases::make("hsh", 7);
    const auto outgoing = hshfit::OutgoingSet::parabolic(32, 32);

    // f cos(theta_i) over the incoming direction, for each of the 1024 outgoing ones.
    hshfit::ProjectionOptions options;
    options.quantity = hshfit::Quantity::brdfCosine;
    const auto projection = hshfit::project(*brdf, *basis, outgoing, options);
    const auto& coefficients = projection.coefficients;

    // The captured energy, Eq. 15 of the HSH paper, for each number of bands.
    for (int order = 1; order <= basis->order(); ++order)
        fmt::print("{:2} coefficients: {:.6f} of the energy\n", basis->functionCount(order),
                   projection.captured[order - 1] / coefficients.energy.value);
    fmt::print("quadrature error {:.1e}\n", coefficients.error);

    hshfit::writeCoefficients(coefficients, argv[2]);
    return 0;
} catch (const hshfit::Error& error) {
    fmt::print(stderr, "project_example: {}\n", error.what());
    return static_cast<int>(error.code());
}
