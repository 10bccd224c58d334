// SPDX-License-Identifier: GPL-3.0-or-later
// numpy's tables: .npy, .npz and pickles.
#include "baker/import/arrays.h"

#include <doctest/doctest.h>

#include <cmath>

#include "array_bytes.h"
#include "baker/import/import.h"
#include "baker/import/robot_motion.h"
#include "baker/mesh/error.h"
#include "refusal.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using Numbers = std::vector<double>;
using TableShape = std::vector<std::size_t>;
using Texts = std::vector<std::string>;

namespace {

// Written by numpy 1.24: savez_compressed(table=arange(6, dtype='f4').reshape(2, 3), names=array(['hip',
// 'Knie\u00e4']), fps=array(60), who=array({'a': 1}, dtype=object)).
constexpr const char* kNpz =
    "504b0304140000000800000021004fe9002a5500000098000000090014007461626c652e6e7079010010009800000000000000550000"
    "00000000009bec17ea1b10c9c850c650ad9e925a9c5ca46ea5a06e9366a2aea3a09e965f54529498179f5f94920a12774bcc294e058a"
    "17672416a402f91a463a0ac69a3a0ab50a64032e063068b007120e4004c40d40bcc00100504b0304140000000800000021004be2ee16"
    "59000000a8000000090014006e616d65732e6e707901001000a80000000000000059000000000000009bec17ea1b10c9c850c650ad9e"
    "925a9c5ca46ea5a06e136aaaaea3a09e965f54529498179f5f94920a12774bcc294e058a17672416a402f91a463a9a3a0ab50a1400ae"
    "0c0606864c202e6040006f20ce838aa702f113200600504b03041400000008000000210008f757b44600000088000000070014006670"
    "732e6e707901001000880000000000000046000000000000009bec17ea1b10c9c850c650ad9e925a9c5ca46ea5a06e9369a1aea3a09e"
    "965f54529498179f5f94920a12774bcc294e058a17672416a402f91a9a3a0ab50a14012e1b06080000504b0304140000000800000021"
    "00d2a34933ce000000230100000700140077686f2e6e7079010010002301000000000000ce000000000000009bec17ea1b10c9c850c6"
    "50ad9e925a9c5ca46ea5a05ee3afaea3a09e965f54529498179f5f94920a12764bcc294e058a17672416a402f91a9a3a0ab50a9401ae"
    "06e6e4bcd2dc824abde4fca254bddcd29c92ccc4a2a2c44aaef8a2d4e4fcbce292a2d2e412ae4206882aaebc14886c21a337436b2193"
    "33635221737b214b5021ab8637a32654514a4965412a57215b0413030383bf45217b67477b21475021a7863773042350aca690cbcfcf"
    "cfeb3f1080096ffb9242eea4ced8429eda425eb08ac4423e6fc6e2c49242fe243d00504b01021403140000000800000021004fe9002a"
    "55000000980000000900000000000000000000008001000000007461626c652e6e7079504b01021403140000000800000021004be2ee"
    "1659000000a80000000900000000000000000000008001900000006e616d65732e6e7079504b010214031400000008000000210008f7"
    "57b446000000880000000700000000000000000000008001240100006670732e6e7079504b0102140314000000080000002100d2a349"
    "33ce000000230100000700000000000000000000008001a301000077686f2e6e7079504b05060000000004000400d8000000aa020000"
    "0000";

// Written by Python 3.11 with numpy 1.24, by protocol 2, 4 and 5: OrderedDict(fps=30, root=array([[1.5, 2, 3]], '>f4'),
// dof=asfortranarray(arange(6.).reshape(2, 3)), scale=float32(.5), names=['a', 'b'], none=None,
// inner={'flag': True, 'rows': [[1, 2], [3, -400]]}, big=2**40, many=array([1, 2], 'i4')).
constexpr const char* kPickles[] = {
    "800263636f6c6c656374696f6e730a4f726465726564446963740a71002952710128580300000066707371024b1e5804000000726f6f"
    "747103636e756d70792e636f72652e6d756c746961727261790a5f7265636f6e7374727563740a7104636e756d70790a6e6461727261"
    "790a71054b00857106635f636f646563730a656e636f64650a7107580100000062710858060000006c6174696e31710986710a52710b"
    "87710c52710d284b014b014b0386710e636e756d70790a64747970650a710f5802000000663471108988877111527112284b03580100"
    "00003e71134e4e4e4affffffff4affffffff4b0074711462896807580d0000003fc38000004000000040400000711568098671165271"
    "17747118625803000000646f667119680468054b0085711a680b87711b52711c284b014b024b0386711d680f58020000006638711e89"
    "8887711f527120284b0358010000003c71214e4e4e4affffffff4affffffff4b00747122628868075831000000000000000000000000"
    "00000000000840000000000000c3b03f0000000000001040000000000000004000000000000014407123680986712452712574712662"
    "58050000007363616c657127636e756d70792e636f72652e6d756c746961727261790a7363616c61720a7128680f5802000000663471"
    "29898887712a52712b284b0368214e4e4e4affffffff4affffffff4b0074712c62680758040000000000003f712d680986712e52712f"
    "86713052713158050000006e616d657371325d713328580100000061713458010000006271356558040000006e6f6e6571364e580500"
    "0000696e6e657271377d7138285804000000666c61677139885804000000726f7773713a5d713b285d713c284b014b02655d713d284b"
    "034a70feffff6565755803000000626967713e8a0600000000000158040000006d616e79713f680468054b00857140680b8771415271"
    "42284b014b02857143680f5802000000693471448988877145527146284b0368214e4e4e4affffffff4affffffff4b00747147628968"
    "07580800000001000000020000007148680986714952714a74714b62752e",
    "80049531020000000000008c0b636f6c6c656374696f6e73948c0b4f72646572656444696374949394295294288c03667073944b1e8c"
    "04726f6f74948c156e756d70792e636f72652e6d756c74696172726179948c0c5f7265636f6e7374727563749493948c056e756d7079"
    "948c076e6461727261799493944b0085944301629487945294284b014b014b03869468098c0564747970659493948c02663494898887"
    "945294284b038c013e944e4e4e4affffffff4affffffff4b0074946289430c3fc000004000000040400000947494628c03646f669468"
    "08680b4b008594680d87945294284b014b024b03869468128c02663894898887945294284b038c013c944e4e4e4affffffff4affffff"
    "ff4b0074946288433000000000000000000000000000000840000000000000f03f000000000000104000000000000000400000000000"
    "001440947494628c057363616c659468068c067363616c617294939468128c02663494898887945294284b0368224e4e4e4affffffff"
    "4affffffff4b0074946243040000003f94869452948c056e616d6573945d94288c0161948c016294658c046e6f6e65944e8c05696e6e"
    "6572947d94288c04666c616794888c04726f7773945d94285d94284b014b02655d94284b034a70feffff6565758c03626967948a0600"
    "00000000018c046d616e79946808680b4b008594680d87945294284b014b02859468128c02693494898887945294284b0368224e4e4e"
    "4affffffff4affffffff4b00749462894308010000000200000094749462752e",
    "8005952a020000000000008c0b636f6c6c656374696f6e73948c0b4f72646572656444696374949394295294288c03667073944b1e8c"
    "04726f6f74948c126e756d70792e636f72652e6e756d65726963948c0b5f66726f6d62756666657294939428960c000000000000003f"
    "c000004000000040400000948c056e756d7079948c0564747970659493948c02663494898887945294284b038c013e944e4e4e4affff"
    "ffff4affffffff4b007494624b014b0386948c014394749452948c03646f669468082896300000000000000000000000000000000000"
    "000000000840000000000000f03f00000000000010400000000000000040000000000000144094680c8c02663894898887945294284b"
    "038c013c944e4e4e4affffffff4affffffff4b007494624b024b0386948c014694749452948c057363616c65948c156e756d70792e63"
    "6f72652e6d756c74696172726179948c067363616c6172949394680c8c02663494898887945294284b03681b4e4e4e4affffffff4aff"
    "ffffff4b0074946243040000003f94869452948c056e616d6573945d94288c0161948c016294658c046e6f6e65944e8c05696e6e6572"
    "947d94288c04666c616794888c04726f7773945d94285d94284b014b02655d94284b034a70feffff6565758c03626967948a06000000"
    "0000018c046d616e7994680828960800000000000000010000000200000094680c8c02693494898887945294284b03681b4e4e4e4aff"
    "ffffff4affffffff4b007494624b028594681374945294752e"};

std::string bytes_of(const std::string& hex) {
  std::string out;
  for (std::size_t k = 0; k < hex.size(); k += 2)
    out.push_back(static_cast<char>(std::stoi(hex.substr(k, 2), nullptr, 16)));
  return out;
}

// The message of an error, "read" where there is none.
std::string message_of(const auto& read) {
  try {
    read();
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kFile);
    return error.what();
  }
  return "read";
}

Array table(const std::string& bytes) { return parse_npy(bytes, "a.npy"); }

}  // namespace

TEST_CASE("an .npy has its numbers in every type and order of bytes") {
  CHECK(table(npy("'<f8'", "(2,)", raw<double>({1.5, -2}))).numbers == Numbers{1.5, -2});
  CHECK(table(npy("'>f4'", "(1,)", std::string("\xBF\x80\0\0", 4))).numbers == Numbers{-1});
  CHECK(table(npy("'<f2'", "(3,)", raw<std::uint16_t>({0x3C00, 0xC100, 0x0001}))).numbers ==
        Numbers{1, -2.5, std::ldexp(1, -24)});
  CHECK(table(npy("'<i2'", "(2,)", raw<std::int16_t>({-3, 300}))).numbers == Numbers{-3, 300});
  CHECK(table(npy("'>i8'", "(1,)", std::string("\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFE", 8))).numbers == Numbers{-2});
  CHECK(table(npy("'|u1'", "(2,)", "\xC8\x01")).numbers == Numbers{200, 1});
  CHECK(table(npy("'|b1'", "(2,)", std::string("\1\0", 2))).numbers == Numbers{1, 0});
  CHECK(table(npy("'<u4'", "()", raw<std::uint32_t>({4000000000U}))).numbers == Numbers{4e9});
  CHECK(table(npy("'>U2'", "(1,)", std::string("\0\0\0\xE4\0\1\xF6\0", 8))).texts == Texts{"\xC3\xA4\xF0\x9F\x98\x80"});
  CHECK(table(npy("'|S3'", "(2,)", std::string("abcd\0\0", 6))).texts == Texts{"abc", "d"});
  for (const int version : {2, 3}) {
    const Array fortran = table(npy("'<i4'", "(2, 3)", raw<std::int32_t>({0, 3, 1, 4, 2, 5}), true, version));
    CHECK(fortran.numbers == Numbers{0, 1, 2, 3, 4, 5});
    CHECK(fortran.shape == TableShape{2, 3});
  }
}

TEST_CASE("an .npy that cannot be read says why") {
  const auto says = [](const std::string& bytes, const char* part) {
    CHECK(contains(message_of([&] { table(bytes); }), part));
  };
  says(npy("'|O'", "(1,)", "x"), "a.npy: holds Python objects");
  says(npy("'<c16'", "(1,)", std::string(16, 'x')), "'<c16'");
  says(npy("[('a', '<f4')]", "(1,)", "1234"), "several columns");
  says(npy("'<f8'", "(3,)", std::string(23, 'x')), "23 of 24 bytes");
  says(npy("'<f8'", "(4000000000, 4000000000, 4000000000)", ""), "more than");
  says(npy("'<U0'", "(900000000,)", ""), "more than");
  says("\x93NUMPY\7" + std::string(20, ' '), "version 7");
}

TEST_CASE("numpy's own .npz is read, and a table that is not read spoils no other") {
  const Arrays arrays = parse_npz(bytes_of(kNpz), "a.npz");
  CHECK(arrays.at("table").numbers == Numbers{0, 1, 2, 3, 4, 5});
  CHECK(arrays.at("table").shape == TableShape{2, 3});
  CHECK(arrays.at("names").texts == Texts{"hip", "Knie\xC3\xA4"});
  CHECK(frame_rate(arrays, "a.npz") == 60);
  CHECK(message_of([&] { find_table(arrays, "who", "a.npz"); }) ==
        "a.npz: 'who' holds Python objects, which are not read (save numbers or texts)");
}

TEST_CASE("pickles of dictionaries, lists and numpy's tables are read, whatever their protocol") {
  for (const char* pickle : kPickles) {
    const Arrays arrays = parse_pickle(bytes_of(pickle), "a.pkl");
    CHECK(arrays.at("fps").numbers == Numbers{30});
    CHECK(arrays.at("root").numbers == Numbers{1.5, 2, 3});
    CHECK(arrays.at("root").shape == TableShape{1, 3});
    CHECK(arrays.at("dof").numbers == Numbers{0, 1, 2, 3, 4, 5});
    CHECK(arrays.at("scale").numbers == Numbers{0.5});
    CHECK(arrays.at("names").texts == Texts{"a", "b"});
    CHECK(arrays.count("none") == 0);
    CHECK(arrays.at("inner/flag").numbers == Numbers{1});
    CHECK(arrays.at("inner/rows").numbers == Numbers{1, 2, 3, -400});
    CHECK(arrays.at("inner/rows").shape == TableShape{2, 2});
    CHECK(arrays.at("big").numbers == Numbers{1099511627776});
    CHECK(arrays.at("many").numbers == Numbers{1, 2});
  }
}

TEST_CASE("a dictionary with one name around all others is left out") {
  const std::string inner = "}(U\3fpsK\x1eU\1a}U\1bK\2sU\1c}U\1dK\3su";
  const Arrays arrays = parse_pickle("\x80\2}U\4walk" + inner + "s.", "a.pkl");
  CHECK(arrays.at("fps").numbers == Numbers{30});
  CHECK(arrays.at("a/b").numbers == Numbers{2});
  CHECK(arrays.size() == 3);
}

TEST_CASE("a pickle that calls a function is refused by the function's name") {
  const auto error = [](const std::string& bytes) { return message_of([&] { parse_pickle(bytes, "a.pkl"); }); };
  CHECK(contains(error("\x80\2cposix\nsystem\nU\7touch x\x85R."), "a.pkl: holds 'posix.system'"));
  CHECK(contains(error("\x80\4\x8c\10builtins\x8c\4eval\x93."), "'builtins.eval'"));
  CHECK(contains(error("\x80\4\x8c\23joblib.numpy_pickle\x8c\21NumpyArrayWrapper\x93."),
                 "'joblib.numpy_pickle.NumpyArrayWrapper'"));
  CHECK(contains(error("(dp0\n."), "protocol 4"));
  const std::string list_in_itself("\x80\2]q\0h\0a.", 9);
  CHECK(contains(parse_pickle(list_in_itself, "a.pkl").at("").refused, "without end"));
}

TEST_CASE("files that are cut off or have a changed byte are read or refused, and nothing else") {
  const std::string files[] = {bytes_of(kNpz), bytes_of(kPickles[0]), bytes_of(kPickles[1]), bytes_of(kPickles[2]),
                               npy("'<U3'", "(2, 1)", std::string(24, '\1'))};
  const auto parse = [](const std::string& bytes) {
    if (bytes.starts_with("PK"))
      parse_npz(bytes, "a");
    else if (bytes.starts_with('\x93'))
      parse_npy(bytes, "a");
    else
      parse_pickle(bytes, "a");
  };
  std::size_t refused = 0;
  const auto try_it = [&](const std::string& bytes) {
    const std::string error = message_of([&] { parse(bytes); });
    if (error == "read") return;
    ++refused;
    CHECK(error.starts_with("a: "));
    CHECK(error.find('\n') == error.npos);
  };
  for (const std::string& whole : files) {
    for (std::size_t size = 0; size < whole.size(); ++size)
      CHECK(message_of([&] { parse(whole.substr(0, size)); }) != "read");
    for (std::size_t at = 0; at < whole.size(); ++at) {
      for (const int change : {1, 0x10, 0x80, 0xFF}) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ change);
        try_it(bytes);
      }
    }
  }
  CHECK(refused > 1000);
}

TEST_CASE("a robot's motion is read from GMR's tables, and goes to no human") {
  const TemporaryFolder folder;
  const Numbers places{0, 0, 0.8, 0.1, 0, 0.8}, upright{0, 0, 0.6, 0.8, 0, 0, 0, 1},
      w_first{0.8, 0, 0, 0.6, 1, 0, 0, 0};
  const auto file = [&](const char* name, const Numbers& turns) {
    return folder.write(name, npz({{"fps", npy({50}, "()")},
                                   {"root_pos", npy(places, "(2, 3)")},
                                   {"root_rot", npy(turns, "(2, 4)")},
                                   {"dof_pos", npy({1, 2, 3, 4, 5, 6}, "(2, 3)")},
                                   {"dof_names", npy(Texts{"knee", "hip", "neck"})}}));
  };
  for (const auto& path : {file("a.npz", upright), file("b.npz", w_first)}) {
    CAPTURE(path.string());
    const RobotMotion motion = read_robot_arrays(path);
    CHECK(motion.fps == 50);
    REQUIRE(motion.frames() == 2);
    CHECK(motion.root_positions[1] == Vec3(0.1, 0, 0.8));
    CHECK(motion.root_rotations[0].isApprox(Eigen::Quaterniond(0.8, 0, 0, 0.6)));
    CHECK(motion.joint_count == 3);
    CHECK(motion.values(1)[2] == 6);
    CHECK(motion.joint_names == Texts{"knee", "hip", "neck"});
  }
  CHECK(contains(refusal(folder.path / "a.npz", [](const auto& path) { read_source(path); }), "motion of a robot"));
  const auto read = [](const auto& path) { read_robot_arrays(path); };
  CHECK(contains(refusal(folder.write("g.npz", npz({{"dof_pos", npy({1}, "(1, 1)")}})), read), "no 'root_pos'"));
}
