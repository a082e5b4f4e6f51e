// The bytes are a mixture of Gaussians. A file that parses is evaluated and written again.

#include <brdfs/fit/gaussian_mixture_json.h>
#include <hshfit/error.h>

#include <fuzz/check_brdf.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const auto mixture = brdfs::openGaussianMixture(text, "input");
        test::checkBrdf(*mixture);
        // Degrees become radians and back; the number of lobes does not change.
        const auto again =
            brdfs::openGaussianMixture(brdfs::gaussianMixtureJson(*mixture), "again");
        const auto &a = mixture->content().elevations, &b = again->content().elevations;
        if (a.size() != b.size() || a[0].lobes.size() != b[0].lobes.size()) std::abort();
    } catch (const InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
        // The written file has to be read.
        if (std::strncmp(error.what(), "again", 5) == 0) std::abort();
    }
    return 0;
}
