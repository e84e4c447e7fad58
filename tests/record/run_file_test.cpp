// Run files: what is written is read back; what is no run file is refused with its reason.
#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "tests/length.hpp"
#include "tests/record/small_run.hpp"

namespace verisim::run_file_test {
namespace {

using namespace small_run;

TEST(RunFile, GivesBackEveryRowAndColumn) {
  const Folder folder;
  write(folder.file("run.h5"), 1234);
  const RunFile run(folder.file("run.h5"));
  EXPECT_EQ(run.rows(), 1234u);
  EXPECT_EQ(first_wrong_row(run), 1234u);
  EXPECT_FALSE(run.recovered());
  const Schema written = schema();
  ASSERT_EQ(run.schema().columns().size(), written.columns().size());
  EXPECT_EQ(run.schema().state_bytes(), written.state_bytes());
  for (std::size_t i = 0; i < written.columns().size(); ++i) {
    const Column &a = written.columns()[i], &b = run.schema().columns()[i];
    EXPECT_EQ(a.path, b.path);
    EXPECT_EQ(a.dtype, b.dtype);
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.units, b.units);
    EXPECT_EQ(a.description, b.description);
    EXPECT_EQ(a.enum_names, b.enum_names);
    EXPECT_EQ(a.due, b.due);
  }
}

TEST(RunFile, GivesBackHeaderSummaryAndEvents) {
  const Folder folder;
  {
    Recorder recorder(folder.file("run.h5"), schema(), header(), {});
    record(recorder, 0, 3);
    recorder.event(0.25, "insertion", "pin passed");
    recorder.close({{"outcome", std::string("inserted")}, {"wall_s", 0.5}, {"frames", std::int64_t{3}}},
                   {{"state_hash", std::string("00ff")}});
  }
  const RunFile run(folder.file("run.h5"));
  EXPECT_EQ(run.header().attributes.at("format"), Attribute(std::string("verisim-run")));
  EXPECT_EQ(run.header().attributes.at("scenario"), Attribute(std::string("pin.lua")));
  EXPECT_EQ(run.header().attributes.at("seed"), Attribute(std::int64_t{42}));
  EXPECT_EQ(run.header().attributes.at("dt"), Attribute(0.001));
  EXPECT_EQ(run.header().attributes.at("state_hash"), Attribute(std::string("00ff")));
  EXPECT_EQ(run.summary().at("outcome"), Attribute(std::string("inserted")));
  EXPECT_EQ(run.summary().at("wall_s"), Attribute(0.5));
  EXPECT_EQ(run.summary().at("frames"), Attribute(std::int64_t{3}));
  ASSERT_EQ(run.events().size(), 1u);
  EXPECT_EQ(run.events()[0].time, 0.25);
  EXPECT_EQ(run.events()[0].kind, "insertion");
  EXPECT_EQ(run.events()[0].text, "pin passed");
}

NamedArray table(const std::string& name, std::vector<std::size_t> shape, const std::vector<float>& values) {
  return NamedArray::from<float>(name, std::span<const float>(values), std::move(shape), "m", "Numbers of " + name);
}

// `replay` lives from this alone: names that hold '/', that are equal, that are empty; contents of any bytes.
TEST(RunFile, GivesBackInputsExactly) {
  const Folder folder;
  RunHeader head = header();
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  head.files = {{"scenes/pin.lua", "aa", "addObject{}\n", true},
                {"z", "bb", bytes, true},
                {"a", "cc", "", true},
                {"big", "dd", "", false}};
  head.models = {
      {"models/a/b.step|deflection=0.001",
       {{"pin", {table("z/1", {2, 3}, {1, 2, 3, 4, 5, 6}), table("a", {0, 3}, {}), table("scalar", {}, {7})}},
        {"pin", {table("z/2", {1}, {9})}}}},
      {"", {{"a/b", {}}}},
      {"empty", {}}};
  for (int i = 0; i < 12; ++i)
    head.files.push_back({"n" + std::to_string(i), "", std::to_string(i), true});  // 10 after 9
  write(folder.file("run.h5"), 1, head);
  const RunFile run(folder.file("run.h5"));
  ASSERT_EQ(run.header().files.size(), head.files.size());
  for (std::size_t i = 0; i < head.files.size(); ++i) {
    EXPECT_EQ(run.header().files[i].name, head.files[i].name);
    EXPECT_EQ(run.header().files[i].sha256, head.files[i].sha256);
    EXPECT_EQ(run.header().files[i].content, head.files[i].content);
    EXPECT_EQ(run.header().files[i].embedded, head.files[i].embedded);
  }
  ASSERT_EQ(run.header().models.size(), head.models.size());
  for (std::size_t i = 0; i < head.models.size(); ++i) {
    const StoredModel &a = head.models[i], &b = run.header().models[i];
    EXPECT_EQ(a.key, b.key);
    ASSERT_EQ(a.parts.size(), b.parts.size());
    for (std::size_t j = 0; j < a.parts.size(); ++j) {
      EXPECT_EQ(a.parts[j].first, b.parts[j].first);
      ASSERT_EQ(a.parts[j].second.size(), b.parts[j].second.size());
      for (std::size_t k = 0; k < a.parts[j].second.size(); ++k) {
        const NamedArray &x = a.parts[j].second[k], &y = b.parts[j].second[k];
        EXPECT_EQ(x.name, y.name);
        EXPECT_EQ(x.dtype, y.dtype);
        EXPECT_EQ(x.shape, y.shape);
        EXPECT_EQ(x.bytes, y.bytes);
        EXPECT_EQ(x.units, y.units);
        EXPECT_EQ(x.description, y.description);
      }
    }
  }
}

/// Bytes that look like each of HDF5's structures, with what follows: as if damaged, as if whole, cut off.
std::vector<std::string> look_alikes() {
  std::vector<std::string> all;
  for (const char* signature : {"GCOL",
                                "OHDR",
                                "OCHK",
                                "TREE",
                                "HEAP",
                                "FRHP",
                                "FHDB",
                                "FHIB",
                                "FSHD",
                                "FSSE",
                                "BTHD",
                                "BTLF",
                                "BTIN",
                                "FAHD",
                                "FADB",
                                "EAHD",
                                "EAIB",
                                "EASB",
                                "EADB",
                                "SNOD",
                                "SMTB",
                                "SMLI",
                                "\x89HDF\r\n\x1a\n"})
    for (const std::string& tail :
         {std::string(), std::string("\1\0\0\0", 4), std::string("\1\0\0\0\0\x10\0\0\0\0\0\0", 12),
          std::string("\1\0\0\0\xff\xff\xff\xff\xff\xff\xff\xff", 12), std::string(60, '\xff'), std::string(60, '\0')})
      all.push_back(signature + tail);
  return all;
}

std::string as_far_as_nul(const std::string& text) {
  return text.substr(0, text.find('\0'));
}

/// A run with the bytes in its inputs, events, texts, tables and numbers.
void write_with(const std::string& path, const std::vector<std::string>& bytes) {
  RunHeader head = header();
  std::string together;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    together += bytes[i];
    head.files.push_back({as_far_as_nul(bytes[i]) + std::to_string(i), as_far_as_nul(bytes[i]), bytes[i], true});
    head.attributes["text" + std::to_string(i)] = as_far_as_nul(bytes[i]);
    head.attributes[as_far_as_nul(bytes[i]) + " named"] = 1.0;
  }
  head.attributes["parameters"] = together.substr(0, 1) + as_far_as_nul(together);
  std::vector<float> numbers(together.size() / sizeof(float));
  std::memcpy(numbers.data(), together.data(), numbers.size() * sizeof(float));
  head.models = {{as_far_as_nul(bytes[0]), {{as_far_as_nul(bytes[0]), {table("GCOL", {numbers.size()}, numbers)}}}}};
  Recorder recorder(path, schema(), head, {});
  record(recorder, 0, 3);
  for (const std::string& text : bytes) recorder.event(0.25, "GCOL\1", text);
  recorder.close({{"outcome", as_far_as_nul(bytes[0])}}, {{"state_hash", as_far_as_nul(bytes[0])}});
}

// What is structure is known by what refers to it, not by its first bytes.
TEST(RunFile, MayHoldAnyBytesThatHdf5Knows) {
  const Folder folder;
  const std::vector<std::string> all = look_alikes();
  write_with(folder.file("run.h5"), all);
  const RunFile run(folder.file("run.h5"));
  EXPECT_TRUE(run.altered().empty());
  ASSERT_EQ(run.header().files.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(run.header().files[i].content, all[i]);
  ASSERT_EQ(run.events().size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(run.events()[i].text, as_far_as_nul(all[i]));
  // As a kill would leave it, too: recovery reads the same structures.
  const std::string left = folder.file("left.h5");
  RunHeader head = header();
  head.files = run.header().files;
  {
    Recorder recorder(left, schema(), head, {});
    record(recorder, 0, 3);
    for (const std::string& text : all) recorder.event(0.25, "GCOL\1", text);
  }
  const RunFile recovered(left);
  EXPECT_EQ(recovered.rows(), 3U);
  EXPECT_TRUE(recovered.altered().empty());
}

TEST(RunFile, KnowsADamagedHeapOfTexts) {
  const Folder folder;
  write(folder.file("run.h5"), 3);
  const std::string whole = content_of(folder.file("run.h5"));
  std::size_t heaps = 0;
  for (std::size_t at = whole.find("GCOL"); at != std::string::npos; at = whole.find("GCOL", at + 1)) {
    ++heaps;
    for (const std::size_t byte : {0U, 4U, 8U, 15U, 24U, 31U}) {  // signature, version, size, the first object's size
      std::string damaged = whole;
      damaged[at + byte] = static_cast<char>(damaged[at + byte] ^ 0x41);
      write_content(folder.file("damaged.h5"), damaged);
      const Error e = error_of([&] { RunFile run(folder.file("damaged.h5")); });
      EXPECT_EQ(e.kind(), ErrorKind::input) << "byte " << byte;
    }
  }
  EXPECT_GT(heaps, 0U);
}

// HDF5 keeps short attributes in the object's header, which holds at most 64 kB.
TEST(RunFile, KeepsParametersOfAnyLength) {
  const Folder folder;
  RunHeader head = header();
  head.attributes["parameters"] = std::string(300'000, 'x');
  write(folder.file("run.h5"), 1, head);
  EXPECT_EQ(RunFile(folder.file("run.h5")).header().attributes.at("parameters"), head.attributes["parameters"]);
}

TEST(RunFile, OfNoRowsIsARunFile) {
  const Folder folder;
  write(folder.file("run.h5"), 0);
  EXPECT_EQ(RunFile(folder.file("run.h5")).rows(), 0u);
  EXPECT_EQ(folder.files(), 1u);
}

TEST(RunFile, RefusesWhatIsNoRunFileAndSaysWhy) {
  const Folder folder;
  write_content(folder.file("empty.h5"), "");
  write_content(folder.file("text.h5"), "t,px,py,pz\n");
  write_content(folder.file("signature.h5"), "\x89HDF\r\n\x1a\n");
  const std::pair<std::string, std::string> cases[] = {{"missing.h5", "No such file"},
                                                       {"empty.h5", "is empty"},
                                                       {"text.h5", "not an HDF5 file"},
                                                       {"signature.h5", "ends after 8 bytes"},
                                                       {"", "is a folder"}};
  for (const auto& [name, reason] : cases) {
    const Error e = error_of([&, &file = name] { RunFile run(folder.file(file)); });
    EXPECT_EQ(e.kind(), ErrorKind::input) << name;
    EXPECT_NE(std::string(e.what()).find(reason), std::string::npos) << e.what();
    EXPECT_EQ(error_of([&, &file = name] { recover(folder.file(file)); }).kind(), ErrorKind::input) << name;
  }
}

TEST(RunFile, RefusesALaterFormat) {
  const Folder folder;
  RunHeader head = header();
  head.attributes["format_version"] = std::int64_t{3};
  write(folder.file("run.h5"), 1, head);
  const Error e = error_of([&] { RunFile run(folder.file("run.h5")); });
  EXPECT_EQ(e.kind(), ErrorKind::input);
  EXPECT_NE(std::string(e.what()).find("later verisim"), std::string::npos) << e.what();
}

TEST(RunFile, RefusesHdf5OfSomethingElse) {
  const Folder folder;
  RunHeader head = header();
  head.attributes["format"] = std::string("weather");
  write(folder.file("run.h5"), 1, head);
  const Error e = error_of([&] { RunFile run(folder.file("run.h5")); });
  EXPECT_EQ(e.kind(), ErrorKind::input);
  EXPECT_NE(std::string(e.what()).find("no run of verisim"), std::string::npos) << e.what();
}

TEST(RunFile, RefusesAFileOfWhichAColumnIsMissing) {
  const Folder folder;
  RunHeader head = header();
  head.attributes["columns"] = std::int64_t{14};
  write(folder.file("run.h5"), 1, head);
  const Error e = error_of([&] { RunFile run(folder.file("run.h5")); });
  EXPECT_EQ(e.kind(), ErrorKind::input);
  EXPECT_NE(std::string(e.what()).find("of 14 columns 13 are there"), std::string::npos) << e.what();
}

TEST(RunFile, RefusesEveryTruncation) {
  const Folder folder;
  write(folder.file("run.h5"), 300);
  const std::string whole = content_of(folder.file("run.h5"));
  for (std::size_t length = 0; length < whole.size(); length += whole.size() / 60) {
    write_content(folder.file("cut.h5"), whole.substr(0, length));
    EXPECT_EQ(error_of([&] { RunFile run(folder.file("cut.h5")); }).kind(), ErrorKind::input) << length << " bytes";
  }
}

/// Reads everything of a run file.
void read_all(const std::string& path) {
  const RunFile run(path);
  for (const Column& c : run.schema().columns()) static_cast<void>(run.column(c));
  static_cast<void>(run.events());
}

// Metadata carry checksums: a flipped bit is either found or lies in the numbers themselves, which `replay --verify`
// finds.
TEST(RunFile, SurvivesFlippedBits) {
  const Folder folder;
  RunHeader head = header();
  head.files = {{"pin.lua", "aa", "addObject{}\n", true}};
  head.models = {{"pin", {{"pin", {table("vertices", {2, 3}, {1, 2, 3, 4, 5, 6})}}}}};
  write(folder.file("run.h5"), 40, head);
  const std::string whole = content_of(folder.file("run.h5"));
  const RandomStream random(1, "flipped bits");
  std::size_t refused = 0;
  const auto flips = test::by_length<std::uint64_t>(300, 1500, 1500);
  for (std::uint64_t i = 0; i < flips; ++i) {
    std::string damaged = whole;
    damaged[random.bits(2 * i) % whole.size()] ^= static_cast<char>(1 << (random.bits(2 * i + 1) % 8));
    write_content(folder.file("damaged.h5"), damaged);
    const Error e = error_of([&] { read_all(folder.file("damaged.h5")); });
    if (e.kind() == ErrorKind::check_failed) continue;
    EXPECT_EQ(e.kind(), ErrorKind::input) << e.what();
    ++refused;
  }
  EXPECT_GT(refused, flips / 30) << "no flip met the structure of the file: this test would prove nothing";
}

}  // namespace
}  // namespace verisim::run_file_test
