#include <hshfit/error.h>
#include <hshfit/files/exr_stream.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace hshfit::inline files {
namespace {

long checked(long result) {
    if (result < 0) {
        throw OutputError(fmt::format("cannot write an EXR file that cannot be sought in: {}",
                                      std::generic_category().message(errno)));
    }
    return result;
}

}  // namespace

void ExrToFile::write(const char bytes[], int count) {
    file_.write(std::string_view(bytes, static_cast<std::size_t>(count)));
}

std::uint64_t ExrToFile::tellp() {
    return static_cast<std::uint64_t>(checked(std::ftell(file_.stream())));
}

void ExrToFile::seekp(std::uint64_t position) {
    checked(std::fseek(file_.stream(), static_cast<long>(position), SEEK_SET));
}

bool ExrFromMemory::read(char out[], int count) {
    const auto wanted = static_cast<std::size_t>(count);
    if (position_ > bytes_.size() || wanted > bytes_.size() - position_) {
        throw std::runtime_error("the file ends too early");
    }
    std::memcpy(out, bytes_.data() + position_, wanted);
    position_ += wanted;
    return position_ < bytes_.size();
}

}  // namespace hshfit::inline files
