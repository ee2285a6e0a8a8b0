#include "services/recognition/cameras/frame.hpp"

#include <opencv2/imgproc.hpp>

namespace prehend::recognition {

Expected<Picture> to_picture(const cv::Mat& frame, const std::string& where) {
  if (frame.cols < 8 || frame.rows < 8) return fail("gives a picture of less than 8 px", where);
  if (frame.total() > 40'000'000)
    return fail("gives a picture of more than 40 million pixels", where, "choose a smaller format");
  cv::Mat narrow = frame;
  if (frame.depth() == CV_16U) frame.convertTo(narrow, CV_8U, 1.0 / 256);
  Picture picture(frame.cols, frame.rows);
  cv::Mat rgb(frame.rows, frame.cols, CV_8UC3, picture.rgb.data());
  switch (narrow.type()) {
    case CV_8UC1:
      cv::cvtColor(narrow, rgb, cv::COLOR_GRAY2RGB);
      return picture;
    case CV_8UC3:
      cv::cvtColor(narrow, rgb, cv::COLOR_BGR2RGB);
      return picture;
    case CV_8UC4:
      cv::cvtColor(narrow, rgb, cv::COLOR_BGRA2RGB);
      return picture;
    default:
      return fail("gives pictures of an unknown format", where, "grey or colour, 8 or 16 bits");
  }
}

}  // namespace prehend::recognition
