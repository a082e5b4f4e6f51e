#include "item_work.h"

#include "program.h"
#include "redirected_streams.h"

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <new>

namespace hshfit::jobs {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr int deepestAnswer = 12;
constexpr std::string_view answerName = "answer.json", recordName = "record.json",
                           messagesName = ".messages";
constexpr std::string_view memoryWords = "not enough memory";

std::string textOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// `text` with the folder in which the item was made taken out of its paths.
std::string withoutFolder(std::string text, const fs::path& part) {
    const std::string whole = part.string(), inside = whole + "/";
    const auto replace = [&](const std::string& what, const std::string& with) {
        for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
            text.replace(at, what.size(), with);
    };
    replace(inside, "");
    replace(whole, ".");
    return text;
}

/// The last line, without the name of the program.
std::string messageOf(std::string text) {
    while (text.ends_with('\n')) text.pop_back();
    text = text.substr(text.rfind('\n') + 1);
    constexpr std::string_view program = "hshfit: ";
    return printable(text.starts_with(program) ? text.substr(program.size()) : text);
}

/// Processor time of this process and of the ended ones that it started.
double cpuSeconds() {
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    double sum = 0;
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        ::getrusage(who, &usage);
        sum += seconds(usage.ru_utime) + seconds(usage.ru_stime);
    }
    return sum;
}

/// Lets the kernel's peak of resident memory start from what is resident now.
void restartPeak() {
    std::ofstream("/proc/self/clear_refs") << "5";
}

std::uint64_t peakBytes() {
    std::ifstream status("/proc/self/status");
    status.exceptions(std::ios::badbit);
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
    return 0;
}

std::map<std::string, std::uint64_t> filesIn(const fs::path& folder) {
    std::map<std::string, std::uint64_t> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            files[entry.path().lexically_relative(folder).string()] = entry.file_size();
    return files;
}

json orderJson(const ItemOrder& order) {
    return {{"part", order.part.string()},
            {"place", order.place.string()},
            {"words", order.words},
            {"record", json::parse(jsonText(recordJson(order.record)))}};
}

ItemOrder orderOf(const std::string& text) {
    const json order = json::parse(text);
    return {.part = order["part"].get<std::string>(),
            .place = order["place"].get<std::string>(),
            .words = order["words"].get<std::vector<std::string>>(),
            .record = recordFromJson(order["record"], "order")};
}

/// Runs the words; the answer and the messages stay in files of the part.
int runWords(const ItemOrder& order, const BatchProgram& program) {
    const RedirectedStreams redirected(order.part / answerName, order.part / messagesName);
    return program.run(order.words);
}

/// Turns the files of the streams into the answer and the record's message.
void takeStreams(const ItemOrder& order, ItemRecord& record) {
    const fs::path messages = order.part / messagesName, answer = order.part / answerName;
    if (!record.isDone()) record.message = withoutFolder(messageOf(textOf(messages)), order.part);
    fs::remove(messages);
    const std::string text = textOf(answer);
    const std::string relative = withoutFolder(text, order.part);
    if (text.empty())
        fs::remove(answer);
    else if (relative != text)
        writeFile(answer.string(), relative);
}

void finish(const ItemOrder& order, ItemRecord record) {
    record.outputs = filesIn(order.part);
    writeFile((order.part / recordName).string(), jsonText(recordJson(record), 1) + "\n");
    publish(order.part, order.place);
}

}  // namespace

std::string orderText(const ItemOrder& order) {
    return jsonText(orderJson(order));
}

std::string makeItem(const std::string& text, const BatchProgram& program) {
    ItemOrder order;
    try {
        order = orderOf(text);
        ItemRecord& record = order.record;
        fs::remove_all(order.part);
        fs::create_directory(order.part);
        restartPeak();
        using Clock = std::chrono::steady_clock;
        const auto start = Clock::now();
        const double cpuStart = cpuSeconds();
        record.exitCode = runWords(order, program);
        record.seconds = std::chrono::duration<double>(Clock::now() - start).count();
        record.cpuSeconds = cpuSeconds() - cpuStart;
        record.peakBytes = peakBytes();
        takeStreams(order, record);
        finish(order, record);
    } catch (const std::bad_alloc&) {
        recordFailure(order, static_cast<int>(ExitCode::numeric), std::string(memoryWords));
    } catch (const std::exception& error) {
        recordFailure(order, static_cast<int>(ExitCode::output), error.what());
    }
    return jsonText(recordJson(order.record));
}

ItemRecord madeItem(const std::string& text) {
    return recordFromJson(parseJson(text, "a process of the batch", deepestAnswer),
                          "a process of the batch");
}

void recordFailure(ItemOrder& order, int exitCode, const std::string& message) {
    order.record.exitCode = exitCode;
    order.record.message = message;
    try {
        fs::remove_all(order.part);
        fs::create_directory(order.part);
        finish(order, order.record);
    } catch (const std::exception&) {
        // Where nothing can be written, the reply to the batch says the rest.
    }
}

void recordDeath(ItemOrder& order, int signal) {
    order.record.signal = signal;
    recordFailure(
        order, static_cast<int>(ExitCode::numeric),
        signal > 0 ? fmt::format("the process ended by signal {} ({})", signal, ::strsignal(signal))
                   : "the process ended before its work");
}

bool lackedMemory(const ItemRecord& record) {
    return !record.isDone() && record.message.find(memoryWords) != std::string::npos;
}

}  // namespace hshfit::jobs
