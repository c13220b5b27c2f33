#include "graspd/recorded/answers_file.hpp"

#include <nlohmann/json.hpp>

#include "graspd/codec/codec.hpp"

namespace graspd::recorded {
namespace {

using Json = nlohmann::ordered_json;

Answered read(const Json& line) {
  Answered answered{line.at("name"), line.at("depth_crc32"), PlanAnswer{}};
  const auto code = parse_enum<Code>(line.at("code").get<std::string>());
  if (!code) throw std::runtime_error("there is no such code");
  if (*code == Code::kOk) {
    answered.answer = codec::plan_answer_from_json(line.at("answer").dump());
    if (!answered.answer) throw std::runtime_error(answered.answer.error().message);
  } else {
    answered.answer = fail(*code, "{}", line.at("message").get<std::string>());
  }
  return answered;
}

}  // namespace

Result<AnswersWriter> AnswersWriter::create(const std::filesystem::path& path) {
  AnswersWriter writer(path);
  if (!writer.file_) {
    return invalid("{}: can't be written; does its folder exist, and may you write there?",
                   path.string());
  }
  return writer;
}

Result<void> AnswersWriter::add(const Answered& answered) {
  Json line{{"name", answered.name}, {"depth_crc32", answered.depth_crc32}};
  if (answered.answer) {
    line["code"] = name_of(Code::kOk);
    line["answer"] = Json::parse(codec::to_json(*answered.answer, false));
  } else {
    line["code"] = name_of(answered.answer.error().code);
    line["message"] = answered.answer.error().message;
  }
  file_ << line.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n' << std::flush;
  if (!file_) {
    return fail(Code::kInternal, "{}: can't be written; is the disk full?", path_.string());
  }
  return {};
}

Result<AnswersReader> AnswersReader::open(const std::filesystem::path& path) {
  AnswersReader reader(path);
  if (!reader.file_)
    return invalid("{}: there is no such file, or you may not read it", path.string());
  return reader;
}

Result<std::optional<Answered>> AnswersReader::next() {
  std::string line;
  if (!std::getline(file_, line)) return std::nullopt;
  ++line_n_;
  try {
    return read(Json::parse(line));
  } catch (const std::exception& error) {
    return invalid("{}:{}: no answer of 'grasp replay --out', or it was cut short: {}",
                   path_.string(), line_n_, error.what());
  }
}

}  // namespace graspd::recorded
