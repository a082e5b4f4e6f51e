// The bytes are an MIT file.

#include <brdfs/measured/gridded/mit.h>
#include <hshfit/error.h>

#include <fuzz/gridded_checks.h>

#include <cstdint>
#include <cstring>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        hshfit::fuzz::check(hshfit::brdfs::MitBrdf({data, size}, "input"));
    } catch (const hshfit::InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    }
    return 0;
}
