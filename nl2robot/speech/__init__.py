"""Speech in and out, on this machine alone.

Hearing
    audio        any recording or live sound -> 16 kHz mono samples; webm: what browsers record
    microphone   samples as they come
    listening    when somebody speaks; streaming: their words while they do
    recogniser   samples and what may be said -> the words, and whether to believe them
                 vosk_decoder: word by word; second_ear: utterances as a whole, and what to believe
    moonshine    English, whisper German and French: the networks of the second ear
                 search: the texts that one may write; subwords, byte_pairs: what it writes them in;
                 expectation: what is likely to be said; log_mel, ct2_file: what Whisper looks at
    answers      what may be answered to a question, and which answer was given
    replies      what somebody replied to the robot, at a microphone
    vocabulary   words that the speech model can never hear, and what to call them instead
    digits       which digit a short sound is, by the sound alone; digits_encoder: Moonshine's part
                 in it; digits_training makes it, digits_speakers: who says them then
    hotword      "hey robot" and "stop", always; spotting: any other word; hotword_training
                 makes them, of what hotword_voices and hotword_corpus say
                 hotword_judge: its second stage; hotword_limits: where that draws its line

Speaking
    voices       text -> sound; sentences: what is spoken at a time; kept: what was spoken before
                 voice_process: where that happens; voice_worker: what runs there, under the GPL
    kokoro       many voices, for trainings and benchmarks
    speaking     one text after the other, silent at once; loudspeaker: where the sound goes
    echo_cancelling  the robot's own voice, taken out of what is heard
    full_duplex  who speaks over the robot is let speak; open_microphone: and answers its question
    people       the voices of the simulated people
    aloud        a run that is heard

Measuring
    levels       how loud a sound is
    scenes       noise and rooms; trials: what is said in them to measure how well it is heard
    benchmark    how fast it is; delay, hotword_benchmark, speaking_benchmark, echo_benchmark
"""
