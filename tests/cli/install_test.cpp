// An installation in a folder of its own reads pictures.

#include "places.h"
#include "program.h"

#include <nlohmann/json.hpp>

namespace hshfit::test {
namespace {

class Installation : public Cli {};

TEST_F(Installation, ProgramFindsItsModuleForPicturesBesideIt) {
    const std::string build = fs::path(program()).parent_path();
    const std::string install =
        "cmake --install " + build + " --prefix " + path("prefix") + " >" + path("log") + " 2>&1";
    ASSERT_EQ(std::system(install.c_str()), 0) << read(path("log"));
    const std::string module = path("prefix/lib/hshfit/libhshfit_openimageio.so");
    ASSERT_TRUE(fs::exists(module));
    std::ofstream picture(path("grey.pfm"), std::ios::binary);
    picture << "Pf\n4 2\n-1.0\n";
    const std::vector<float> values(8, 0.5F);
    picture.write(reinterpret_cast<const char*>(values.data()), 32);
    picture.close();
    // The folder is moved, so that nothing depends on the prefix.
    fs::rename(path("prefix"), path("moved"));
    const std::string job = "LD_DEBUG=files " + path("moved/bin/hshfit") + " info " +
                            path("grey.pfm") + " --json >" + path("out") + " 2>" + path("trace");
    ASSERT_EQ(std::system(job.c_str()), 0) << read(path("trace"));
    EXPECT_EQ(nlohmann::json::parse(read(path("out")))["kind"], "light");
    // The dynamic loader says that it took this module, and not the one of the build.
    EXPECT_NE(read(path("trace")).find(path("moved/lib/hshfit/libhshfit_openimageio.so")),
              std::string::npos);
}

TEST_F(Installation, HasTheManualAndCompletionWhereManAndShellsLook) {
    const std::string build = fs::path(program()).parent_path();
    const std::string install =
        "cmake --install " + build + " --prefix " + path("prefix") + " >" + path("log") + " 2>&1";
    ASSERT_EQ(std::system(install.c_str()), 0) << read(path("log"));
    const fs::path share = path("prefix/share");
    for (const std::string shell : {"bash", "zsh", "fish"}) {
        const std::string file = shell == "bash"  ? "bash-completion/completions/hshfit"
                                 : shell == "zsh" ? "zsh/site-functions/_hshfit"
                                                  : "fish/vendor_completions.d/hshfit.fish";
        EXPECT_EQ(read(share / file), run("completion " + shell).out) << file;
    }
    // The installed pages are the pages that this program writes, and the page of hshfit-mpi.
    ASSERT_EQ(run("manual -o " + path("man")).code, 0);
    const std::string differ = "diff -r -x hshfit-mpi.1 " + path("man") + " " +
                               (share / "man").string() + " >" + path("log");
    EXPECT_EQ(std::system(differ.c_str()), 0) << read(path("log"));
    if (std::system("command -v man groff >/dev/null") != 0)
        GTEST_SKIP() << "man or groff is not installed";
    const std::string show = "MANPATH=" + (share / "man").string() + " man hshfit-project >" +
                             path("shown") + " 2>&1 </dev/null";
    ASSERT_EQ(std::system(show.c_str()), 0) << read(path("shown"));
    EXPECT_NE(read(path("shown")).find("HSHFIT-PROJECT(1)"), std::string::npos);
}

}  // namespace
}  // namespace hshfit::test
