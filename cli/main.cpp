#include "command.h"
#include "run_words.h"
#include "wording.h"

#include <hshfit/files/atomic_file.h>

#include <algorithm>
#include <string>
#include <vector>

int main(int argc, char** argv) {
#ifdef HSHFIT_NEEDS_AVX2  // HSHFIT_INSTRUCTION_SETS=own
    if (!__builtin_cpu_supports("avx2")) {
        hshfit::cli::printMessage(
            "this program was built for processors with AVX2, which this one has not; build it "
            "here, or with -DHSHFIT_INSTRUCTION_SETS=all");
        return 1;
    }
#endif
    hshfit::cli::occupyStandardStreams();
    hshfit::removeTemporariesOnSignals();
    hshfit::cli::endUncaughtInOneLine();
    hshfit::setWording(hshfit::cli::optionWording());
    return hshfit::cli::runWords(std::vector<std::string>(argv + std::min(argc, 1), argv + argc));
}
