#include <brdfs/fit/resampling.h>

#include <random>

namespace hshfit::brdfs {

std::vector<std::vector<std::size_t>> scanMembers(const FitSamples& samples) {
    std::vector<std::vector<std::size_t>> members;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const std::size_t scan = samples.scans.empty() ? k : samples.scans[k];
        if (scan >= members.size()) members.resize(scan + 1);
        members[scan].push_back(k);
    }
    return members;
}

std::vector<std::size_t> timesDrawn(const std::vector<std::vector<std::size_t>>& members,
                                    std::size_t count, std::uint64_t seed, std::size_t draw) {
    std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                        static_cast<std::uint32_t>(draw),
                        static_cast<std::uint32_t>(std::uint64_t{draw} >> 32)};
    std::mt19937_64 random(words);
    std::vector<std::size_t> times(count, 0);
    for (std::size_t i = 0; i < members.size(); ++i)
        for (const std::size_t k : members[random() % members.size()]) ++times[k];
    return times;
}

FitSamples redrawn(const FitSamples& samples, std::uint64_t seed, std::size_t draw) {
    const std::vector<std::size_t> times =
        timesDrawn(scanMembers(samples), samples.size(), seed, draw);
    std::vector<std::size_t> chosen;
    for (std::size_t k = 0; k < samples.size(); ++k)
        if (times[k] > 0) chosen.push_back(k);
    FitSamples result = samples.subset(chosen);
    for (std::size_t i = 0; i < chosen.size(); ++i)
        result.weights[i] *= static_cast<double>(times[chosen[i]]);
    return result;
}

}  // namespace hshfit::brdfs
