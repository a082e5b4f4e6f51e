#include <hshfit/files/printable.h>

namespace hshfit::inline files {

std::string printable(std::string_view text) {
    std::string out(text);
    for (char& c : out) {
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
    }
    return out;
}

}  // namespace hshfit::inline files
