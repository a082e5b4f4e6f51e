// The share of synthetic scans whose truth the stated errors of fits hold:
//     fit_coverage CSV [REPEATS] [SCANS]
// fits REPEATS (2000) times SCANS (200) scans of tests/brdfs/instrument_scans.h, with the terms of
// their instrument and without any, and writes a row per parameter and kind of fit: coverage of
// intervals of one and of 1.96 errors by scan, sandwich and normal errors, and of Student's
// intervals by scan (scans_student of FIT.json), mean deviation from the truth and mean error.
//     fit_coverage campaigns CSV [REPEATS]
// fits REPEATS (3000) times the campaigns of tests/brdfs/campaigns.h, whose errors the fit is told
// of, and writes a row for each parameter: coverage of intervals of 68.27 and 95.45 % (one and two
// standard errors; by scan, Student's), mean deviation and scatter over the mean half width of the
// first.

#include <brdfs/campaigns.h>
#include <brdfs/fit/distributions.h>
#include <brdfs/instrument_scans.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace hshfit;
using namespace hshfit::brdfs;

struct Routes {
    test::Coverage scans, sandwich, normal;
    std::size_t student68 = 0, student95 = 0;  ///< intervals by scan that hold the truth
    double degrees = 0;
    double share(std::size_t holding) const {
        return static_cast<double>(holding) / static_cast<double>(scans.count);
    }
    void add(double deviation, const ParameterUncertainty& own) {
        scans.add(deviation, *own.scans);
        degrees += *own.scanDegrees;
        const auto holds = [&](double outside) {
            return std::abs(deviation) < studentBound(outside, *own.scanDegrees) * *own.scans;
        };
        student68 += holds(std::erfc(std::sqrt(0.5)));
        student95 += holds(0.05);
        sandwich.add(deviation, *own.sandwich);
        normal.add(deviation, *own.normal);
    }
};

void report(const char* kind, const char* name, double value, const Routes& own,
            std::ofstream& csv) {
    const double bias = own.scans.bias(), error = own.scans.error();
    csv << fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", kind, name, value,
                       own.scans.one(), own.scans.two(), own.sandwich.one(), own.sandwich.two(),
                       own.normal.one(), own.normal.two(), bias, error, own.share(own.student68),
                       own.share(own.student95),
                       own.degrees / static_cast<double>(own.scans.count));
    fmt::print(
        "{:<12} {:<6} Student {:.3f} {:.3f} ({:.0f} degrees)  by scan {:.3f} {:.3f}  sandwich "
        "{:.3f} {:.3f}  normal {:.3f} {:.3f}  "
        "off by {:+.2f} % = {:+.1f} errors, scatter {:.2f} errors\n",
        kind, name, own.share(own.student68), own.share(own.student95),
        own.degrees / static_cast<double>(own.scans.count), own.scans.one(), own.scans.two(),
        own.sandwich.one(), own.sandwich.two(), own.normal.one(), own.normal.two(),
        100 * bias / value, bias / error, own.scans.deviation() / error);
}

int runCampaigns(const char* path, std::size_t repeats) {
    std::ofstream csv(path);
    csv << "campaign,parameter,within_1,within_2,deviation,scatter\n";
    for (const test::Campaign& campaign : test::campaigns()) {
        std::vector<FitResult> results(repeats);
        tbb::parallel_for(std::size_t{0}, repeats, [&](std::size_t r) {
            results[r] = fit(campaign.measured(1000 + r), campaign.options);
            results[r].uncertainty->values.clear();
        });
        for (std::size_t i = 0; i < results.front().parameters.size(); ++i) {
            const FittedParameter& first = results.front().parameters[i];
            if (first.instrument) continue;
            const test::Coverage own = test::coverageOf(results, i);
            const std::string name =
                first.channel.empty() ? first.name : first.name + " " + first.channel;
            const double bias = own.bias() / own.error(), scatter = own.deviation() / own.error();
            csv << fmt::format("{},{},{},{},{},{}\n", campaign.name, name, own.one(), own.two(),
                               bias, scatter);
            fmt::print("{:<24} {:<18} {:.3f} {:.3f}  off by {:+.2f} half widths, scatter {:.2f}\n",
                       campaign.name, name, own.one(), own.two(), bias, scatter);
        }
    }
    csv.close();
    return csv ? 0 : 5;
}

int run(int argc, char** argv) {
    if (argc < 2 || (std::string_view(argv[1]) == "campaigns" && argc < 3)) {
        fmt::print(stderr,
                   "usage: fit_coverage CSV [REPEATS] [SCANS]\n"
                   "       fit_coverage campaigns CSV [REPEATS]\n");
        return 2;
    }
    if (std::string_view(argv[1]) == "campaigns")
        return runCampaigns(argv[2],
                            argc > 3 ? static_cast<std::size_t>(std::atol(argv[3])) : 3000);
    const auto count = [&](int k, std::size_t otherwise) {
        return argc > k ? static_cast<std::size_t>(std::atol(argv[k])) : otherwise;
    };
    const std::size_t repeats = count(2, 2000), scans = count(3, 200);
    const test::ScanTruth truth;
    const FitSamples exact = test::exactScans(truth, scans, 2026);
    std::vector<FitResult> with(repeats), without(repeats);
    tbb::parallel_for(std::size_t{0}, repeats, [&](std::size_t r) {
        std::mt19937_64 random(1000 + r);
        const FitSamples samples = test::noisyScans(exact, truth, random);
        with[r] = fit(samples, test::scanFit(truth, true));
        without[r] = fit(samples, test::scanFit(truth, false));
        // Only the study of parameters is of interest here.
        with[r].uncertainty->values.clear();
        without[r].uncertainty->values.clear();
    });
    std::ofstream csv(argv[1]);
    csv << "fit,parameter,truth,scans_68,scans_95,sandwich_68,sandwich_95,normal_68,normal_95,"
           "mean_deviation,mean_error,student_68,student_95,degrees\n";
    const std::pair<const char*, double> values[] = {
        {"alpha", truth.alpha}, {"kd", truth.kd}, {"ks", truth.ks}, {"dark", truth.dark}};
    for (const bool terms : {true, false}) {
        const auto& results = terms ? with : without;
        for (std::size_t i = 0; i < (terms ? 4u : 3u); ++i) {
            Routes own;
            for (const FitResult& result : results)
                own.add(result.parameters[i].value - values[i].second,
                        result.uncertainty->parameters[i]);
            report(terms ? "instrument" : "none", values[i].first, values[i].second, own, csv);
        }
        double chiSquare = 0, degrees = 0;
        for (const FitResult& result : results) {
            chiSquare += result.uncertainty->chiSquare;
            degrees += static_cast<double>(result.uncertainty->degreesOfFreedom);
        }
        fmt::print("{:<12} chi-square {:.3f} each\n", terms ? "instrument" : "none",
                   chiSquare / degrees);
    }
    csv.close();
    return csv ? 0 : 5;
}

}  // namespace

int main(int argc, char** argv) try { return run(argc, argv); } catch (const std::exception& e) {
    fmt::print(stderr, "fit_coverage: {}\n", e.what());
    return 1;
}
