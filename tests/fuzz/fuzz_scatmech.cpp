// The bytes are a SCATMECH coefficient table.

#include <brdfs/measured/scattered/scatmech.h>
#include <fuzz/check_brdf.h>
#include <hshfit/error.h>

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const char* element : {"m00", "m12", "dolp", "all"}) try {
            test::checkBrdf(*brdfs::readScatmech(text, "input", "input",
                                                 {.elements = brdfs::MuellerElements(element)}));
        } catch (const InputError&) {
        }
    brdfs::scatmechFormat().recognises({data, size < 4096 ? size : 4096}, size);
    return 0;
}
