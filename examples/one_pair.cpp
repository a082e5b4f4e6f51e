// f of one pair of directions after another, from a file of coefficients or of a compressed form:
// one_pair FILE, with theta_i phi_i theta_o phi_o in degrees on each line of the standard input.
#include <brdfs/catalog.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/hshfit.h>
#include <hshfit/representation/forms/pair_evaluators.h>
#include <hshfit/representation/one_pair.h>

#include <cstdio>
#include <vector>

int main(int argc, char** argv) try {
    if (argc != 2) throw hshfit::UsageError("usage: one_pair FILE");
    const auto form = hshfit::readRepresentation(argv[1]);
    const auto evaluator = hshfit::pairEvaluator(form, hshfit::brdfs::open);
    std::vector<float> f(form.head.channels.count());
    const auto direction = [](double theta, double phi) {
        return hshfit::directionFromAngles(hshfit::radians(theta), hshfit::radians(phi));
    };
    for (double a[4]; std::scanf("%lf %lf %lf %lf", a, a + 1, a + 2, a + 3) == 4;) {
        hshfit::evaluate(*evaluator, direction(a[0], a[1]), direction(a[2], a[3]), f.data());
        for (const float value : f) std::printf("%.6g ", static_cast<double>(value));
        std::printf("\n");
    }
} catch (const hshfit::Error& error) {
    std::fprintf(stderr, "one_pair: %s\n", error.what());
    return static_cast<int>(error.code());
}
