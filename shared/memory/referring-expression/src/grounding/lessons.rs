//! Lessons and views: objects that were taught or seen at a time.

use super::{Grounder, Judgement};
use crate::expression::LessonAuthor;
use crate::time_phrase::{TimePhrase, TimeWindow, duration_text};
use crate::tokens::WordSpan;
use crate::world::{Lesson, WorldObject};

/// Score of an object that only has the category of a lesson.
const CATEGORY_SCORE: f64 = 0.6;

/// Score of an earlier lesson if no time is said.
const EARLIER_SCORE: f64 = 0.7;

impl Grounder<'_> {
    pub(super) fn judge_taught(
        &mut self,
        author: LessonAuthor,
        time: Option<TimePhrase>,
        span: WordSpan,
    ) -> Vec<Judgement> {
        let world = self.world;
        let name = match author {
            LessonAuthor::Speaker => world.speaker.map(str::to_lowercase),
            LessonAuthor::Named(name) => Some(self.text(name).to_lowercase()),
            LessonAuthor::Anyone => None,
        };
        if author == LessonAuthor::Speaker && name.is_none() {
            self.doubt("who `I` is is not known: lessons of all people count".to_owned());
        }
        let is_by_author = |lesson: &&Lesson| {
            name.as_ref()
                .is_none_or(|name| lesson.author.to_lowercase() == *name)
        };
        let lessons: Vec<&Lesson> = world.lessons.iter().filter(is_by_author).collect();
        let window = time.map(|time| time.window(world.now_ns, world.utc_offset_s));
        let latest_ns = lessons.iter().map(|lesson| lesson.wall_ns).max();
        let weight = |lesson: &Lesson| match window {
            Some(window) => window.score(lesson.wall_ns),
            None if Some(lesson.wall_ns) == latest_ns => 1.0,
            None => EARLIER_SCORE,
        };
        let text = self.text(span);
        let judge = |object: &WorldObject| {
            let scored = lessons.iter().map(|lesson| (*lesson, weight(lesson)));
            let judged =
                scored.map(|(lesson, weight)| self.judge_lesson(object, lesson, weight, &text));
            let best = judged.max_by(|a, b| a.score.total_cmp(&b.score));
            best.unwrap_or_else(|| Judgement::new(0.0, "", format!("was not `{text}`")))
        };
        world.objects.iter().map(judge).collect()
    }

    /// Judges an object by one lesson: the object that was shown, or one of its category.
    fn judge_lesson(
        &self,
        object: &WorldObject,
        lesson: &Lesson,
        weight: f64,
        text: &str,
    ) -> Judgement {
        let track = object.track_id;
        let is_shown = lesson.track_id == Some(track);
        let shown_is_here = self
            .world
            .objects
            .iter()
            .any(|o| lesson.track_id == Some(o.track_id));
        let is_of_category = !shown_is_here && object.best_name() == Some(lesson.category.as_str());
        let score = match (is_shown, is_of_category) {
            (true, _) => weight,
            (_, true) => CATEGORY_SCORE * weight,
            _ => 0.0,
        };
        let age = duration_text(self.world.now_ns.saturating_sub(lesson.wall_ns));
        let category = &lesson.category;
        let fit = format!("was shown {age} ago as {category} by {}", lesson.author);
        Judgement::new(score, fit, format!("was not `{text}`"))
            .doubt_if(!is_shown && score > 0.0, || {
                format!("track {track} has the category of that lesson, {category}, but may be another object")
            })
            .doubt_if(score > 0.0 && weight < 1.0, || {
                format!("the lesson for track {track} was {age} ago")
            })
    }

    pub(super) fn judge_seen(&self, time: TimePhrase, span: WordSpan) -> Vec<Judgement> {
        self.judge_interval(time, span, "was seen", |window, object| {
            window.score_of_interval(object.first_seen_ns, object.last_seen_ns)
        })
    }

    pub(super) fn judge_appeared(&self, time: TimePhrase, span: WordSpan) -> Vec<Judgement> {
        self.judge_interval(time, span, "appeared", |window, object| {
            window.score(object.first_seen_ns)
        })
    }

    fn judge_interval(
        &self,
        time: TimePhrase,
        span: WordSpan,
        verb: &str,
        score: fn(TimeWindow, &WorldObject) -> f64,
    ) -> Vec<Judgement> {
        let window = time.window(self.world.now_ns, self.world.utc_offset_s);
        let text = self.text(span);
        let judge = |object: &WorldObject| {
            let score = score(window, object);
            let track = object.track_id;
            Judgement::new(score, format!("{verb} then"), format!("was not `{text}`"))
                .doubt_if(score < 1.0, || {
                    format!("track {track} {verb} only near that time")
                })
        };
        self.world.objects.iter().map(judge).collect()
    }
}
