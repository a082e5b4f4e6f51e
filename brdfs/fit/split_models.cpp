#include <brdfs/fit/split_models.h>

#include <algorithm>
#include <cctype>
#include <map>

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

std::vector<std::string> termNames(std::string_view spec) {
    std::vector<std::string> models;
    for (const std::string& part : splitModels(spec))
        models.push_back(part.substr(0, part.find(':')));
    std::vector<std::string> names = models;
    std::map<std::string_view, int> taken;
    for (std::size_t k = 0; k < names.size(); ++k) {
        const int number = ++taken[models[k]];
        if (std::ranges::count(models, models[k]) > 1) names[k] += std::to_string(number);
    }
    return names;
}

std::string parameterName(const std::vector<std::string>& names, std::size_t term,
                          std::string_view key) {
    return names.size() > 1 ? names[term] + "." + std::string(key) : std::string(key);
}

std::string withoutNumber(std::string_view parameter) {
    const std::size_t dot = parameter.find('.');
    if (dot == parameter.npos) return std::string(parameter);
    std::size_t end = dot;
    while (end > 0 && std::isdigit(static_cast<unsigned char>(parameter[end - 1]))) --end;
    return std::string(parameter.substr(0, end)) + std::string(parameter.substr(dot));
}

}  // namespace hshfit::brdfs
