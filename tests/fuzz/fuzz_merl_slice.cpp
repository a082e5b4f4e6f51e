// Either a picture of slices (the bytes are an EXR file), or the values of a `.slice` file: what
// is given, over and over until the file is full. An odd last octet leaves a byte out.

#include <brdfs/measured/gridded/slice.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_header.h>

#include <fuzz/gridded_checks.h>

#include <cstdint>
#include <cstring>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        if (hshfit::hasExrMagic({reinterpret_cast<const char*>(data), size})) {
            hshfit::fuzz::check(*hshfit::brdfs::readSlicePicture({data, size}, "input"));
        } else if (size > 0) {
            std::vector<unsigned char> bytes(97200 - data[size - 1] % 2);
            for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = data[i % size];
            hshfit::fuzz::check(*hshfit::brdfs::readMerlSlice(bytes, "input"));
        }
    } catch (const hshfit::InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    }
    return 0;
}
