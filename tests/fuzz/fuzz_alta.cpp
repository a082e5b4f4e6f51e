// The bytes are a file of ALTA: data, as text or binary, or a fitted function.

#include <brdfs/measured/scattered/alta.h>
#include <brdfs/measured/scattered/scattered.h>
#include <fuzz/check_brdf.h>
#include <hshfit/error.h>

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        if (text.starts_with("#ALTA FUNC HEADER")) {
            // With the parametrisation that the file states, and with another.
            test::checkBrdf(*brdfs::readAltaFunction(text, "input"));
            test::checkBrdf(*brdfs::readAltaFunction(text, "input", "COS_TH_TD"));
        } else {
            test::checkBrdf(brdfs::Scattered(brdfs::readAlta(text, "input"), {}, "input"));
        }
    } catch (const InputError&) {
    }
    brdfs::altaFormat().recognises({data, size < 4096 ? size : 4096}, size);
    return 0;
}
