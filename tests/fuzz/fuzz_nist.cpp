// The bytes are a file of the format nist.

#include <brdfs/measured/scattered/nist.h>
#include <brdfs/measured/scattered/scattered.h>
#include <fuzz/check_brdf.h>
#include <hshfit/error.h>

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const char* element : {"m00", "m12", "dolp", "all"}) try {
            test::checkBrdf(brdfs::Scattered(
                brdfs::readNist(text, "input", brdfs::MuellerElements(element)), {}, "input"));
        } catch (const InputError&) {
        }
    brdfs::nistFormat().recognises({data, size < 4096 ? size : 4096}, size);
    return 0;
}
