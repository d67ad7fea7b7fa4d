// How search results are ordered: pages named by the words, then sections, then objects of the
// API, then pages that hold the words anywhere.
var Scorer = {
  score: ([, , anchor, , score, , kind]) => {
    if (kind === "title") return 100 + score + (anchor ? 0 : 100);
    return kind === "object" ? 50 + score : score;
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
