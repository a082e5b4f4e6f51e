// The bytes are a file of the format pab-opto.

#include <brdfs/measured/scattered/pab_opto.h>
#include <brdfs/measured/scattered/scattered.h>
#include <fuzz/check_brdf.h>
#include <hshfit/error.h>

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit;
    try {
        const std::string_view text(reinterpret_cast<const char*>(data), size);
        test::checkBrdf(brdfs::Scattered(brdfs::readPabOpto(text, "input"), {}, "input"));
    } catch (const InputError&) {
    }
    brdfs::pabOptoFormat().recognises({data, size < 4096 ? size : 4096}, size);
    return 0;
}
