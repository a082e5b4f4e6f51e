#include <brdfs/fit/split_models.h>

#include <cctype>

namespace hshfit::brdfs {

std::vector<std::string> splitModels(std::string_view spec) {
    std::vector<std::string> parts(1);
    for (std::size_t k = 0; k < spec.size(); ++k) {
        std::size_t next = k + 1;
        while (next < spec.size() && spec[next] == ' ') ++next;
        const bool letter =
            next < spec.size() && std::isalpha(static_cast<unsigned char>(spec[next]));
        if (spec[k] == '+' && letter) {
            parts.emplace_back();
        } else if (spec[k] != ' ') {
            parts.back() += spec[k];
        }
    }
    return parts;
}

}  // namespace hshfit::brdfs
