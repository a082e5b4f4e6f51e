// The bytes are a file of the format bird.

#include <brdfs/measured/scattered/bird.h>
#include <brdfs/measured/scattered/scattered.h>
#include <fuzz/check_brdf.h>
#include <hshfit/error.h>

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit;
    try {
        const std::string_view text(reinterpret_cast<const char*>(data), size);
        test::checkBrdf(brdfs::Scattered(brdfs::readBird(text, "input"), {}, "input"));
    } catch (const InputError&) {
    }
    brdfs::birdFormat().recognises({data, size < 4096 ? size : 4096}, size);
    return 0;
}
