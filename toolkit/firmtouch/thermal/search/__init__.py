"""The best sensor that meets what is asked, out of parts and sizes, and what one objective costs of another."""

from firmtouch.thermal.search.candidate import Candidate
from firmtouch.thermal.search.front import Front
from firmtouch.thermal.search.search import SearchResult, search
from firmtouch.thermal.search.variables import Variable

__all__ = ["Candidate", "Front", "SearchResult", "Variable", "search"]
