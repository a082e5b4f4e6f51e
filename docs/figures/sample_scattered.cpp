// sample_scattered samples|curve THETA CHANNEL SPEC: the plane of incidence of scattered samples
// for wi at THETA degrees, for scattered.gp. `samples`: columns angle, value of the samples in that
// plane (within half a degree of it and of THETA); `curve`: angle, interpolant, covered. The mirror
// direction has the sign of +.

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/scattered.h>
#include <hshfit/error.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace {

using namespace hshfit;

void printSamples(const brdfs::Samples& samples, double theta, std::size_t channel) {
    const double near = radians(0.5);
    for (std::size_t k = 0; k < samples.size(); ++k) {
        if (std::fabs(polarAngle(samples.wi[k]) - theta) > near) continue;
        const Direction o = rotateAboutZ(samples.wo[k], pi - azimuth(samples.wi[k]));
        if (std::fabs(o.y) > std::sin(near)) continue;
        std::printf("%g %g\n", degrees(std::atan2(o.x, o.z)),
                    samples.values[k * samples.channels.count() + channel]);
    }
}

void printCurve(const Brdf& brdf, double theta, std::size_t channel) {
    const Direction wi = directionFromAngles(theta, pi);
    for (double angle = -89.75; angle < 90; angle += 0.25) {
        const Direction wo = directionFromAngles(radians(angle), 0);
        unsigned char covered = 0;
        brdf.coverage(wo, {&wi.x, &wi.y, &wi.z, 1}, &covered);
        std::printf("%g %g %d\n", angle, evaluate(brdf, wi, wo)[channel], covered);
    }
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 5) return static_cast<int>(ExitCode::usage);
    try {
        const auto brdf = brdfs::open(arguments[4]);
        const double theta = radians(std::atof(arguments[2]));
        const auto channel = static_cast<std::size_t>(std::atoi(arguments[3]));
        const auto* scattered = dynamic_cast<const brdfs::Scattered*>(brdf.get());
        if (!scattered || channel >= brdf->channels().count()) {
            return static_cast<int>(ExitCode::usage);
        }
        if (std::string_view(arguments[1]) == "curve") {
            printCurve(*brdf, theta, channel);
        } else {
            printSamples(scattered->samples(), theta, channel);
        }
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return static_cast<int>(error.code());
    }
}
