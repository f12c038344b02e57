#include "markers.h"

#if defined(PLANEFOLD_ARUCO_OF_OBJDETECT)
#include <opencv2/objdetect/aruco_detector.hpp>
#elif defined(PLANEFOLD_HAVE_ARUCO)
#include <opencv2/aruco.hpp>
#endif

namespace pf::calibrate {

namespace {

struct Dictionary {
  int markers, number;
  const char* name;
};

// Numbers as OpenCV gives them to its dictionaries of 4 x 4 bits.
constexpr Dictionary kDictionaries[] = {
    {50, 0, "DICT_4X4_50"}, {100, 1, "DICT_4X4_100"}, {250, 2, "DICT_4X4_250"}, {kMostMarkers, 3, "DICT_4X4_1000"}};

const Dictionary& dictionary_of(const Board& board) {
  for (const Dictionary& dictionary : kDictionaries) {
    if (board.markers() <= dictionary.markers) {
      return dictionary;
    }
  }
  return kDictionaries[3];
}

}  // namespace

const char* dictionary_name(const Board& board) { return dictionary_of(board).name; }

/// Of a row: the first white square, and how many there are.
static int first_white(const Board& board, int row) { return board.is_dark(0, row) ? 1 : 0; }
static int whites(const Board& board, int row) { return (board.columns - first_white(board, row) + 1) / 2; }

// Numbers run over the white squares row by row.
cv::Point square_of_marker(const Board& board, int number) {
  for (int row = 0, first = 0; row < board.rows; ++row) {
    const int here = whites(board, row);
    if (number < first + here) {
      return {2 * (number - first) + first_white(board, row), row};
    }
    first += here;
  }
  return {-1, -1};
}

int marker_in_square(const Board& board, int column, int row) {
  if (column < 0 || row < 0 || column >= board.columns || row >= board.rows || board.is_dark(column, row)) {
    return -1;
  }
  int first = 0;
  for (int y = 0; y < row; ++y) {
    first += whites(board, y);
  }
  return first + column / 2;
}

#ifdef PLANEFOLD_HAVE_ARUCO

namespace {

/// OpenCV 4.7 took the markers over from its contributed modules, with another interface.
#ifdef PLANEFOLD_ARUCO_OF_OBJDETECT
cv::aruco::Dictionary opencv_dictionary(const Board& board) {
  return cv::aruco::getPredefinedDictionary(dictionary_of(board).number);
}

void detect(const cv::Mat& grey, const Board& board, std::vector<std::vector<cv::Point2f>>& corners,
            std::vector<int>& numbers) {
  cv::aruco::ArucoDetector(opencv_dictionary(board)).detectMarkers(grey, corners, numbers);
}
#else
cv::aruco::Dictionary opencv_dictionary(const Board& board) {
  return *cv::aruco::Dictionary::get(dictionary_of(board).number);
}

void detect(const cv::Mat& grey, const Board& board, std::vector<std::vector<cv::Point2f>>& corners,
            std::vector<int>& numbers) {
  cv::aruco::detectMarkers(grey, cv::aruco::Dictionary::get(dictionary_of(board).number), corners, numbers);
}
#endif

}  // namespace

bool have_markers() { return true; }

std::vector<Marker> find_markers(const cv::Mat& grey, const Board& board) {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> numbers;
  detect(grey, board, corners, numbers);
  std::vector<Marker> markers;
  for (size_t i = 0; i < numbers.size(); ++i) {
    markers.push_back({numbers[i], {corners[i][0], corners[i][1], corners[i][2], corners[i][3]}});
  }
  return markers;
}

cv::Mat marker_modules(const Board& board, int number) {
  const cv::Mat bytes = opencv_dictionary(board).bytesList.rowRange(number, number + 1);
  const cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(bytes, 4);
  cv::Mat modules = cv::Mat::zeros(6, 6, CV_8U);
  bits.copyTo(modules(cv::Rect(1, 1, 4, 4)));
  return modules;
}

#else

bool have_markers() { return false; }
std::vector<Marker> find_markers(const cv::Mat&, const Board&) { return {}; }
cv::Mat marker_modules(const Board&, int) { return {}; }

#endif

}  // namespace pf::calibrate
