// The bytes are a file of light. A file that reads is also written and read again, and has to be
// the same.

#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/error.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    try {
        const hshfit::LightCoefficients light = hshfit::lightFromJson(bytes, "input");
        if (light.values.size() != light.channels.count() * light.slots()) std::abort();
        const auto again = hshfit::lightFromJson(hshfit::lightToJson(light), "again");
        if (again.values != light.values || again.basis != light.basis ||
            again.domain != light.domain || again.source != light.source ||
            again.curves.size() != light.curves.size()) {
            std::abort();
        }
    } catch (const hshfit::InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    }
    return 0;
}
